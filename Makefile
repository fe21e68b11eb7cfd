# PackCell: `make help` lists the targets.
SHELL := /bin/bash
CELL ?= packing
SEED ?= 0
ARGS ?=
# Three on two cores: in many tests everybody waits, for simulated time or for a node to start.
WORKERS ?= 3
IN_ENV := source tools/env.sh &&

.PHONY: help setup demo test slow bench fuzz mutation regression lint docs lock clean

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z]+:.*## / {printf "  make %-10s %s\n", $$1, $$2}' Makefile
	@echo '  e.g. make demo SEED=3 ARGS="--no-video" (.venv/bin/pack demo packing --help)'
	@echo '       make demo takes 3 to 6 minutes the first time, about 1 afterwards'
	@echo '       make demo ARGS="--live" shows the run in the browser while it goes on'

setup: ## make .venv, install and build; does only what has changed
	@PYTHON="$(PYTHON)" tools/setup.sh

demo: setup ## run and report (CELL=packing, palletizing, blocks; SEED; ARGS)
	@$(IN_ENV) pack demo $(CELL) --seed $(SEED) $(ARGS)

# PYTHONDONTWRITEBYTECODE=: pytest keeps the tests that it has rewritten; else every worker rewrites all, for 10 s.
test: setup ## tests but benchmarks (ARGS for pytest; WORKERS=0: one process)
	@echo "Compiling what takes longest (a minute the first time)"
	@$(IN_ENV) python -m pack_bringup.compiling
	@$(IN_ENV) PYTHONDONTWRITEBYTECODE= pytest -n $(WORKERS) --dist loadfile --no-loadscope-reorder \
		--benchmark-disable --durations=30 -m "not benchmark and not long" $(ARGS)

slow: setup ## tests that take minutes: cells in a browser, most demos
	@$(IN_ENV) pytest -m long $(ARGS)

bench: setup ## measure speed and success (ARGS goes to the command)
	@$(IN_ENV) pytest -m benchmark && pack benchmark $(CELL) $(ARGS)

fuzz: setup ## broken files and messages through every reader (ARGS)
	@$(IN_ENV) PYTHONPATH=tests:$$PYTHONPATH python -m fuzz $(ARGS)

mutation: setup ## small faults, which unit tests must notice (ARGS: parts)
	@.venv/bin/uv pip install -q --python .venv/bin/python --require-hashes -r requirements/mutation.txt
	@$(IN_ENV) PYTHONPATH=tests:$$PYTHONPATH nice -n 19 python -m mutation $(ARGS)

regression: setup ## compare two versions (ARGS="record DIR", "compare A B")
	@$(IN_ENV) PYTHONPATH=tests:$$PYTHONPATH python -m regression $(ARGS)

lint: setup ## ruff, formatting, mypy
	@$(IN_ENV) ruff check && ruff format --check && mypy

docs: setup ## reference of the code from docstrings, with its links checked
	@$(IN_ENV) python tools/api_reference.py

lock: setup ## resolve requirements/*.in anew
	@cd requirements && ../.venv/bin/uv pip compile -q --universal --python-version 3.11 --no-annotate \
		--generate-hashes run.in build.in dev.in -o locked.txt
	@cd requirements && ../.venv/bin/uv pip compile -q --universal --python-version 3.11 --no-annotate \
		--generate-hashes -c locked.txt cluster.in -o cluster.txt
	@cd requirements && ../.venv/bin/uv pip compile -q --universal --python-version 3.11 --no-annotate \
		--generate-hashes -c locked.txt mutation.in -o mutation.txt
	@cd requirements && ../.venv/bin/uv pip compile -q --universal --python-version 3.11 --no-annotate \
		--generate-hashes -c locked.txt opcua.in -o opcua.txt

clean: ## remove .venv and everything built; recordings in bags/ stay
	rm -rf .venv ros_ws/build ros_ws/install ros_ws/log .mypy_cache .pytest_cache .ruff_cache
