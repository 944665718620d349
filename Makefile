# The front door: `make help` lists what it does. CMake builds (CMakePresets.json); this file only
# installs what is missing and calls it.

BUILD  := build
PRESET ?= release
PREFIX ?= /usr/local
JOBS   ?= $(shell nproc)

# Debian 12 packages. A list is installed only when a target needs it, and only what is missing.
BUILD_PACKAGES := g++ cmake ninja-build pkg-config libglm-dev libhwy-dev libtbb-dev libfmt-dev \
  nlohmann-json3-dev libopenexr-dev libtinygltf-dev libcli11-dev libopencolorio-dev \
  libopenimageio-dev libpng-dev libyaml-cpp-dev zlib1g-dev libdraco-dev libmeshoptimizer-dev libjs-chart.js
TEST_PACKAGES  := libgtest-dev libgmock-dev qemu-user clang-format-14 \
  openimageio-tools opencolorio-tools openexr
BENCH_PACKAGES := libembree-dev libbenchmark-dev povray
# The page of a comparison is tested in Chromium. A Node.js of another origin is as good as Debian's.
PAGE_PACKAGES  := chromium $(if $(shell command -v npm),,nodejs npm)
TIDY_PACKAGES  := clang-format-14 clang-tidy-14

# Objects are reused between clones where ccache is installed.
CONFIGURE = cmake --preset $(PRESET) $(if $(shell command -v ccache),-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)

.DEFAULT_GOAL := help
.PHONY: help prism build test test-sanitize bench bless format tidy install clean \
  deps-build deps-test deps-page deps-bench deps-tidy configure

help: ## Lists the targets.
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-14s %s\n", $$1, $$2 }' $(firstword $(MAKEFILE_LIST))

prism: build ## Renders the glass prism to out/prism.exr and out/prism.png.
	@mkdir -p out
	$(BUILD)/bin/abbe render scenes/prism/prism.gltf --size 1280x720 --bands 380:780:20 \
	  --view "Spectral Hue - SDR Video" -o out/prism.exr -o out/prism.png
	@echo
	@echo "The prism, scene-linear with spectral bands: $(CURDIR)/out/prism.exr"
	@echo "The prism, as seen on an sRGB display:       $(CURDIR)/out/prism.png"

build: configure ## Builds the release program at build/bin/abbe.
	cmake --build $(BUILD) --parallel $(JOBS) --target abbe_program

# A folder that is configured stays as it is: CMake itself sees what has changed.
configure: deps-build
	@test -f $(BUILD)/build.ninja || $(CONFIGURE) -DABBE_BUILD_TESTS=OFF

test: deps-test ## Builds everything and runs every test.
	$(CONFIGURE) -DABBE_BUILD_TESTS=ON
	cmake --build --preset $(PRESET) --parallel $(JOBS)
	ctest --preset $(PRESET) --parallel $(JOBS)

test-sanitize: PRESET := sanitize
test-sanitize: deps-test ## Runs every test under the address and undefined-behaviour sanitizers.
	$(CONFIGURE) -DABBE_BUILD_TESTS=ON
	cmake --build --preset $(PRESET) --parallel $(JOBS)
	ctest --preset $(PRESET) --parallel $(JOBS)

bench: deps-bench ## Runs the benchmarks: ratios, measured in one run, to out/bench*.json.
	$(CONFIGURE) -DABBE_BUILD_TESTS=ON -DABBE_BUILD_BENCHMARKS=ON
	cmake --build $(BUILD) --parallel $(JOBS) --target abbe_bench abbe_render_bench \
	  abbe_exact_bench abbe_uplift_bench
	$(BUILD)/tests/bench/abbe_bench
	$(BUILD)/tests/bench/abbe_render_bench --povray
	$(BUILD)/tests/bench/abbe_exact_bench
	$(BUILD)/tests/bench/abbe_uplift_bench

bless: build ## Renews golden images: make bless CASE=prism_spectral; prints the measured difference.
	$(BUILD)/bin/abbe golden renew tests/golden/images $(addprefix --only ,$(CASE))

format: deps-tidy ## Formats the sources with clang-format.
	git ls-files --cached --others --exclude-standard 'src/*.h' 'src/*.cpp' 'tests/*.h' 'tests/*.cpp' \
	  | xargs clang-format-14 -i

tidy: configure deps-tidy ## Runs clang-tidy over src/.
	git ls-files --cached --others --exclude-standard 'src/*.cpp' \
	  | xargs -n 1 -P $(JOBS) clang-tidy-14 --quiet -p $(BUILD)

install: build ## Installs program, library and data: make install PREFIX=/usr/local.
	cmake --install $(BUILD) --prefix $(PREFIX)

clean: ## Removes everything that was built or rendered.
	rm -rf build build-debug build-sanitize out

# Installs the packages of a list that are missing; touches neither apt nor the network when none is.
define install_packages
	@command -v dpkg-query >/dev/null || { \
	  echo "This is no Debian system: the packages needed are $(1)."; exit 0; }; \
	missing=; \
	for package in $(1); do \
	  dpkg-query -W -f '$${db:Status-Status}\n' $$package 2>/dev/null | grep -qx installed \
	    || missing="$$missing $$package"; \
	done; \
	test -n "$$missing" || exit 0; \
	if test "$$(id -u)" = 0; then as_root=env; \
	elif command -v sudo >/dev/null; then as_root="sudo env"; \
	else \
	  echo "Missing:$$missing. Install them as root: apt-get install --no-install-recommends$$missing" >&2; \
	  exit 1; \
	fi; \
	echo "Installing what is missing:$$missing"; \
	$$as_root apt-get update -q || echo "Going on with the package lists at hand."; \
	$$as_root DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $$missing
endef

deps-build:
	$(call install_packages,$(BUILD_PACKAGES))
deps-test: deps-page
	$(call install_packages,$(BUILD_PACKAGES) $(TEST_PACKAGES))
# playwright-core, by its lock file, once: no network where it is already.
deps-page:
	$(call install_packages,$(PAGE_PACKAGES))
	@mkdir -p build/page
	@cmp -s tests/report/page/package-lock.json build/page/installed-lock.json || { \
	  cp tests/report/page/package.json tests/report/page/package-lock.json build/page/ && \
	  npm ci --prefix build/page --ignore-scripts --no-audit --no-fund --prefer-offline && \
	  cp build/page/package-lock.json build/page/installed-lock.json; }
deps-bench: deps-test
	$(call install_packages,$(BENCH_PACKAGES))
deps-tidy:
	$(call install_packages,$(TIDY_PACKAGES))
