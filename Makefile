# Two commands for a new user: `make demo` and `make test`. Each does all of its own set-up.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Byte code is written where it is used: that of the libraries would be a tenth of their size.
INSTALL := -m pip install --quiet --disable-pip-version-check --no-compile --constraint constraints.txt
EXTRAS := train,cad,view,cluster,storage,parquet,matlab,spice,benchmark,ros2,dev,docs
CORE := $(VENV)/.core
ALL := $(VENV)/.installed
LINTED := src tests tools examples

.PHONY: demo test lint blender constraints clean
.DELETE_ON_ERROR:

demo: $(CORE) blender
	$(BIN)/proxnav demo --out out/demo

test: $(ALL) blender lint
	$(BIN)/pytest -n 2 --dist loadgroup --no-loadscope-reorder

lint: $(ALL)
	$(BIN)/ruff check $(LINTED)
	$(BIN)/ruff format --check $(LINTED)
	$(BIN)/lint-imports
	$(BIN)/pyright
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet

blender: $(CORE)
	$(BIN)/proxnav setup blender

$(CORE): pyproject.toml constraints.txt
	@echo "Installing proxnav and what it runs on into $(VENV), 1 GB: a minute, once. Blender follows, 1 GB."
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python $(INSTALL) --editable .
	touch $@

$(ALL): $(CORE)
	@echo "Installing training, viewers, cluster and what the tests need into $(VENV), 7 GB: five to ten minutes, once."
	$(BIN)/python $(INSTALL) --editable '.[$(EXTRAS)]'
	touch $@

# Today's newest releases into constraints.txt; `make test` then says whether proxnav passes with them.
# torch chooses its own CUDA libraries, which differ from machine to machine.
constraints:
	$(PYTHON) -m venv --clear out/newest
	out/newest/bin/python -m pip install --quiet --disable-pip-version-check '.[$(EXTRAS)]'
	out/newest/bin/python -m pip freeze --exclude proxnav | grep -Ev '^(nvidia|cuda)-|^triton=|@' > constraints.txt

clean:
	rm -rf $(VENV) out
	find src -name '*.nb[ci]' -delete
