# Two commands for a new user: `make demo` and `make test`. Each does all of its own set-up.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

.PHONY: demo test lint blender clean
.DELETE_ON_ERROR:

demo: $(STAMP) blender
	$(BIN)/proxnav demo --out out/demo

test: $(STAMP) blender lint
	$(BIN)/pytest

lint: $(STAMP)
	$(BIN)/ruff check src tests tools examples
	$(BIN)/ruff format --check src tests tools examples
	$(BIN)/lint-imports
	$(BIN)/pyright
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet

blender: $(STAMP)
	$(BIN)/proxnav setup blender

$(STAMP): pyproject.toml
	@echo "Installing proxnav and its libraries into $(VENV): about 8 GB, five to ten minutes, once."
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet --editable '.[train,view,cluster,storage,dev,docs]'
	touch $@

clean:
	rm -rf $(VENV) out
	find src -name '*.nb[ci]' -delete
