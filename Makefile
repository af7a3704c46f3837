# Each target does its own set-up: a virtual environment in .venv, made once and again when pyproject.toml changes.
PYTHON ?= python3
BIN := .venv/bin
READY := .venv/ready
OUT := demo_output
# modules are compiled when they are first imported, and most never are; then they are kept, or every program would
# compile them again
QUIETLY := --quiet --disable-pip-version-check --no-compile
unexport PYTHONDONTWRITEBYTECODE
# the oldest of what pyproject.toml allows that this Python can have
OLDEST := 'vtk==9.2.*' 'numpy==1.24.*' 'scipy==1.10.*' 'pyvista==0.43.*'

VERSION = $(shell sed -n 's/^__version__ = "\(.*\)"/\1/p' filters/tetraskel/__init__.py)

.PHONY: demo docs plugin test test-oldest fuzz check format format-check lint types bench compare paraview-numba clean

demo: $(READY)
	mkdir -p $(OUT)
	$(BIN)/tetraskel skeleton sample_data/y_tube.vtp $(OUT)/skeleton.vtp --png $(OUT)/skeleton.png
	@echo "The skeleton is in $(OUT)/skeleton.vtp, its picture in $(OUT)/skeleton.png"

# file by file on two cores; each file in one process, for what its tests share
test: $(READY) .pvpython-packages
	$(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder

# the filters on the oldest VTK, without what takes long and has little to do with VTK's version (the marker `slow`)
test-oldest: .venv-oldest/ready
	.venv-oldest/bin/python -m pytest tests/vtkfilters tests/test_accessor.py -m 'not slow'

docs: .venv/docs-ready
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet
	@echo "The site is in build/site; open build/site/index.html"

# for hours: EXAMPLES and SECONDS of each of its tests
fuzz: $(READY)
	FUZZ_EXAMPLES=$(or $(EXAMPLES),100000) FUZZ_SECONDS=$(or $(SECONDS),3600) \
	    $(BIN)/python -m pytest -s tests/test_fuzz.py

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

# beside other programs, which get an environment of their own; MESHES is a folder of closed meshes (.obj)
compare: $(READY) .venv-peers/ready
	PYTHONPATH=filters $(BIN)/python benchmarks/peers/run.py --python .venv-peers/bin/python --out docs \
	    $(if $(MESHES),--meshes $(MESHES)) $(if $(OBJECTS),--objects "$(OBJECTS)") $(if $(SIZES),--sizes $(SIZES)) $(if $(SECONDS),--seconds $(SECONDS))

.venv-peers/ready: benchmarks/peers/requirements.txt
	$(PYTHON) -m venv .venv-peers
	-while read one; do .venv-peers/bin/python -m pip install $(QUIETLY) "$$one"; done < $<
	touch $@

$(READY): pyproject.toml
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install $(QUIETLY) \
	    --config-settings editable_mode=compat --editable '.[dev]'
	touch $(READY)

.venv/docs-ready: $(READY)
	$(BIN)/python -m pip install $(QUIETLY) \
	    --config-settings editable_mode=compat --editable '.[docs]'
	touch $@

.venv-oldest/ready: pyproject.toml Makefile
	$(PYTHON) -m venv .venv-oldest
	.venv-oldest/bin/python -m pip install $(QUIETLY) $(OLDEST) pytest hypothesis
	touch $@

# pytest for ParaView's own Python: pure Python, and kept apart so that no second VTK comes with it
.pvpython-packages: $(READY)
	if command -v pvpython >/dev/null; then \
	    $(BIN)/python -m pip install $(QUIETLY) --upgrade --target $@ pytest hypothesis; \
	fi

# one zip that a user unpacks anywhere and loads in ParaView
plugin:
	$(PYTHON) tools/plugin_zip.py dist/tetraskel-paraview-$(VERSION).zip

# numba for a ParaView whose Python has the version of $(PYTHON): beside the plugin, which looks for it there; without
# dependencies, because ParaView brings its own NumPy (the versions are those for NumPy 1.24 and later)
paraview-numba: $(READY)
	$(BIN)/python -m pip install $(QUIETLY) --upgrade --no-deps \
	    --target plugin/numba_packages 'numba==0.61.2' 'llvmlite==0.44.0'

clean:
	rm -rf .venv .venv-oldest .venv-peers benchmarks/peers/build .pvpython-packages plugin/numba_packages $(OUT) build dist \
	    *.egg-info filters/*.egg-info
