# Each target does its own set-up: a virtual environment in .venv, made once and again when pyproject.toml changes.
PYTHON ?= python3
BIN := .venv/bin
READY := .venv/ready
OUT := demo_output

.PHONY: demo test check format format-check lint types bench clean

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
	$(BIN)/python benchmarks/tree_speed.py

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

clean:
	rm -rf .venv .pvpython-packages $(OUT) build dist *.egg-info filters/*.egg-info
