# The environment is made once and kept in .venv; constraints.txt makes it repeatable.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
EXTRAS ?= all,dev
# Tests run one process a core.
WORKERS ?= auto

.PHONY: explorer help grade test quick lint correct lines faults fuzz mutation oldest newest proof papers benchmarks reports league catalogue packages site linkcheck lite slides clean

help:
	@echo "make grade       grade scikit-image's marching cubes; says where the report is"
	@echo "make test        every test, slow ones too"
	@echo "make quick       the tests that are not marked slow"
	@echo "make lint        ruff and mypy"
	@echo "make proof       the theorem on cube rules, checked by Coq from nothing, and every rule's tiles"
	@echo "make coverage    count what the default plan covers: reports/coverage.md"
	@echo "make correct     judge every correct extractor of the tests on the whole plan"
	@echo "make faults      judge every fault of the tests on the whole plan; goes on where it stopped"
	@echo "make fuzz        inputs that nobody would write: READER=protocol COUNT=1000; goes on where it stopped"
	@echo "make lines       run the lines of every kept report on the accused and on the reference"
	@echo "make mutation    mutants of oracles and claims; goes on where it stopped"
	@echo "make oldest      the lowest NumPy and SciPy that we support give the same verdicts"
	@echo "make newest      the newest do too (WITH=python3.13: those that this Python has)"
	@echo "make papers      reproduce the papers' tables and figures into reports/papers"
	@echo "make reports     grade every ready-made implementation into reports/implementations"
	@echo "make league      build and grade every package of validation/league, and write the page to choose by; NAMES=\"vtk-js yt\" for some"
	@echo "make catalogue   write what isograde list shows, after a change of claims or cases"
	@echo "make packages    wheel and sdist into dist, checked by twine"
	@echo "make site        the site, in docs/_build; opens from disk"
	@echo "make lite        JupyterLite with the site's notebooks, in docs/_build/lite"
	@echo "make linkcheck   the site's links to other places; says which cannot be reached"
	@echo "make slides      the films of the course and its slides, in docs/_build/slides"
	@echo "make explorer    docs/explorer/explorer.html from its sources (needs node)"
	@echo "make benchmarks  speed and memory beside the peers, and how quiet the machine was"

$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[$(EXTRAS)]"
	@touch $@

grade: $(STAMP)
	@# Status 1 says that claims fail: a finding, not an error of this command.
	$(BIN)/isograde grade skimage:lewiner --out report || [ $$? -eq 1 ]

test: $(STAMP)
	$(BIN)/python -m pytest -n $(WORKERS)

quick: $(STAMP)
	$(BIN)/python -m pytest -n $(WORKERS) -m "not slow"

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# Skips itself, with a word, where there is no coqc (Debian: apt-get install coq).
proof: $(STAMP)
	$(BIN)/python validation/proofs/make.py

correct: $(STAMP)
	$(BIN)/python -m tests.isograde.whole_plan

lines: $(STAMP)
	$(BIN)/python -m tests.isograde.kept_lines

coverage: $(STAMP)
	$(BIN)/python -m tests.isograde.coverage

faults: $(STAMP)
	$(BIN)/python -m tests.isograde.faults.matrix

fuzz: $(STAMP)
	$(BIN)/python -m tests.fuzz.run $(if $(COUNT),--count $(COUNT)) $(READER)

mutation: $(STAMP)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[mutation]"
	$(BIN)/python -m tests.mutation.run

oldest: $(STAMP)
	$(BIN)/python -m tests.isograde.repeated --oldest

newest: $(STAMP)
	$(BIN)/python -m tests.isograde.repeated --newest $(if $(WITH),--python $(WITH))

papers: $(STAMP)
	@for program in $$(grep -l __main__ papers/*/*.py); do echo "== $$program"; $(BIN)/python $$program || exit 1; done

reports: $(STAMP)
	$(BIN)/isograde grade --all --packed --out reports/implementations || [ $$? -eq 1 ]

packages: $(STAMP)
	rm -rf dist
	$(BIN)/python -m build --outdir dist
	$(BIN)/python -m twine check --strict dist/*

catalogue: $(STAMP)
	$(BIN)/python -m isograde.cataloguing

# Goes on where it was cut off; a package that cannot be had costs its own row. NAMES: some alone.
league: $(STAMP)
	$(BIN)/python validation/league/league.py $(NAMES)

# Peers that have an environment of their own are built first; one that cannot be had costs its rows.
benchmarks: $(STAMP)
	$(BIN)/python benchmarks/outside.py
	$(BIN)/python benchmarks/everything.py

# Without a network, but for the packages. A warning stops it, and so does a link that leads nowhere.
site: $(STAMP)
	$(BIN)/python -m sphinx -W --keep-going -q -j 2 -b html docs docs/_build
	$(BIN)/python docs/_ext/isosite/links.py docs/_build
	@echo "open docs/_build/index.html"

linkcheck: $(STAMP)
	rm -f docs/_build/linkcheck/output.json
	$(BIN)/python -m sphinx -Q -b linkcheck -D plot_gallery=0 docs docs/_build/linkcheck || true
	$(BIN)/python docs/_ext/isosite/links.py --elsewhere docs/_build/linkcheck

# Behind `make site`: its notebooks and this project's wheel, for a browser that fetches NumPy itself.
lite: $(STAMP)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[lite]"
	rm -rf docs/_build/lite docs/_build/wheel
	$(BIN)/python -m build --wheel --outdir docs/_build/wheel
	cd docs/lite && ../../$(BIN)/jupyter lite build

# One page that opens from disk; the films are those of the lessons.
slides: $(STAMP)
	$(BIN)/python docs/course/figures.py
	$(BIN)/python -m sphinx -W -q -b revealjs docs/course/slides docs/_build/slides

# Tables from isoref, types, and one file; the packages are pinned by docs/explorer/package-lock.json.
explorer: $(STAMP)
	@command -v npm >/dev/null || { echo "make explorer needs node and npm (Debian: apt-get install nodejs npm)"; exit 1; }
	cd docs/explorer && npm ci --no-fund --no-audit
	mkdir -p docs/explorer/build
	$(BIN)/python docs/explorer/tables.py docs/explorer/build/tables.json
	cd docs/explorer && npm run --silent check && npm run --silent build

clean:
	rm -rf $(VENV) report build dist validation/proofs/build docs/_build
