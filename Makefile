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
	$(BIN)/ruff check src tests
	$(BIN)/ruff format --check src tests
	$(BIN)/lint-imports
	$(BIN)/pyright

blender: $(STAMP)
	$(BIN)/proxnav setup blender

$(STAMP): pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet --editable '.[train,view,dev]'
	touch $@

clean:
	rm -rf $(VENV) out
	find src -name '*.nb[ci]' -delete
