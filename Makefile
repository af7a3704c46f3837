# Each target does its own set-up: a virtual environment in .venv, made once and again when pyproject.toml changes.
PYTHON ?= python3
BIN := .venv/bin
READY := .venv/ready
OUT := demo_output

VERSION = $(shell sed -n 's/^__version__ = "\(.*\)"/\1/p' filters/tetraskel/__init__.py)

.PHONY: plugin demo test check format format-check lint types bench paraview-numba clean

demo: $(READY)
	mkdir -p $(OUT)
	$(BIN)/tetraskel skeleton sample_data/y_tube.vtp $(OUT)/skeleton.vtp --png $(OUT)/skeleton.png
	@echo "The skeleton is in $(OUT)/skeleton.vtp, its picture in $(OUT)/skeleton.png"

test: $(READY) .pvpython-packages
	$(BIN)/python -m pytest

check: format-check lint types test

format: $(READY)
	$(BIN)/ruff format .

format-check: $(READY)
	$(BIN)/ruff format --check .

lint: $(READY)
	$(BIN)/ruff check .

types: $(READY)
	$(BIN)/mypy

bench: $(READY)
	$(BIN)/python benchmarks/run.py --out docs

$(READY): pyproject.toml
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check \
	    --config-settings editable_mode=compat --editable '.[dev]'
	touch $(READY)

# pytest for ParaView's own Python: pure Python, and kept apart so that no second VTK comes with it
.pvpython-packages: $(READY)
	if command -v pvpython >/dev/null; then \
	    $(BIN)/python -m pip install --quiet --disable-pip-version-check --upgrade --target $@ pytest hypothesis; \
	fi

# one zip that a user unpacks anywhere and loads in ParaView
plugin:
	$(PYTHON) tools/plugin_zip.py dist/tetraskel-paraview-$(VERSION).zip

# numba for a ParaView whose Python has the version of $(PYTHON): beside the plugin, which looks for it there; without
# dependencies, because ParaView brings its own NumPy (the versions are those for NumPy 1.24 and later)
paraview-numba: $(READY)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --upgrade --no-deps \
	    --target plugin/numba_packages 'numba==0.61.2' 'llvmlite==0.44.0'

clean:
	rm -rf .venv .pvpython-packages plugin/numba_packages $(OUT) build dist *.egg-info filters/*.egg-info
