# heartgen from a fresh Debian 12: `make demo` goes from a CT to a report, `make test` runs the tests.
# Everything is installed and built on the way; a second call does no work twice.

BUILD := build/release
HEARTGEN := $(BUILD)/bin/heartgen
LAB := $(BUILD)/bin/heartgen-lab
# One compiler needs up to 3 GB: as many jobs as processors, but no more than the memory can hold.
JOBS := $(shell n=$$(nproc); m=$$(awk '/MemAvailable/ {print int($$2 / 3000000)}' /proc/meminfo); \
          [ $$m -lt 1 ] && m=1; [ $$n -lt $$m ] && echo $$n || echo $$m)

# Phantom of the demo: a thorax at the resolution that the README quotes.
DEMO_SIZE := 256,256,160
DEMO_SPACING := 1.4,1.4,1.9

empty :=
comma := ,
CLIENT_FORMATS := $(subst $(empty) $(empty),$(comma),vtk vtu msh msh-ascii msh2 dealii xdmf opencarp opencarp-binary chaste \
  svmultiphysics openfoam cardiacfoam medit mfem cardioid abaqus febio stl ply)

# Damaged files for every reader; seconds for each kind of file.
FUZZ_SECONDS := 60
FUZZ_KINDS := $(notdir $(wildcard tests/fuzz/corpus/*))

# Debian packages and a tarball with all libraries, in dist/.
VERSION := $(shell awk '/^project.heartgen VERSION/ {print $$3}' CMakeLists.txt)
PARTS := heartgen heartgen-tetgen heartgen_shared heartgen_python manual

.PHONY: all deb tarball first-minutes lab demo test test-clients test-machines chaos bench rooms asan tsan fuzz docs format check tidy clean
all: $(HEARTGEN)

lab: $(BUILD)/build.ninja
	cmake --build --preset release --parallel $(JOBS) --target heartgen-lab

build/packages.stamp: .ci/install-packages
	.ci/install-packages
	@mkdir -p build && touch $@

$(BUILD)/build.ninja: build/packages.stamp CMakePresets.json
	cmake --preset release

# Ninja knows what is up to date; the program's own time stamp then tells whether the demo is.
.PHONY: program
program: $(BUILD)/build.ninja
	cmake --build --preset release --parallel $(JOBS) --target heartgen
$(HEARTGEN): program ;

demo/phantom/recipe.toml: $(HEARTGEN)
	rm -rf demo/phantom
	$(HEARTGEN) phantom demo/phantom --size $(DEMO_SIZE) --spacing $(DEMO_SPACING)

demo/bundle/manifest.json: demo/phantom/recipe.toml $(HEARTGEN)
	$(HEARTGEN) build demo/phantom/recipe.toml --output demo/bundle --force

demo/export/markers.stamp: demo/bundle/manifest.json
	rm -rf demo/export
	$(HEARTGEN) export demo/bundle --to vtk,msh,xdmf --output demo/export
	@touch $@

demo: demo/export/markers.stamp
	$(HEARTGEN) validate demo/bundle --reference-labels demo/phantom/truth/labels.nii.gz --reference-fibers demo/phantom/truth
	@echo
	@echo "Bundle: demo/bundle    Exports: demo/export"
	@echo "Open the report in a browser: demo/bundle/validation/report.html"

.PHONY: parts
parts: $(BUILD)/build.ninja build/package.stamp
	cmake --build --preset release --parallel $(JOBS) --target $(PARTS)

deb: parts
	rm -rf $(BUILD)/deb && mkdir -p dist
	SOURCE_DATE_EPOCH=$${SOURCE_DATE_EPOCH:-$$(git log -1 --format=%ct)} cpack --config $(BUILD)/CPackConfig.cmake -B $(BUILD)/deb
	cp $(BUILD)/deb/*.deb dist/
	lintian --fail-on error $$(ls dist/*.deb)
	@ls -l dist/*.deb

tarball: parts
	packaging/make_tarball $(BUILD) dist/heartgen-$(VERSION)-linux-x86_64.tar.gz

# A stranger's first five minutes, in a bare Debian 12; needs root and Debian's mirrors.
demo/bundle.tar.zst: demo/bundle/manifest.json
	rm -f $@ && $(HEARTGEN) pack demo/bundle $@

# What is published, in dist/; RELEASE.md says how. A real heart too where a scan, an atlas and whose they are is given:
#   make release SCAN=ct.nii.gz ATLAS=heart.vtk ATTRIBUTION="Patient 1 of ..., CC BY 3.0; atlas of ..., MPL-2.0"
RELEASED := dist/heartgen-$(VERSION)
.PHONY: release released-heart
ifneq ($(SCAN),)
release: released-heart
released-heart: demo/bundle.tar.zst
	@test -n "$(ATLAS)" && test -n "$(ATTRIBUTION)" || { echo "make release: give ATLAS and ATTRIBUTION with SCAN" >&2; exit 2; }
	mkdir -p dist demo/heart
	printf 'name = "heart"\nversion = "%s"\nattribution = "%s"\n' "$(VERSION)" "$(ATTRIBUTION)" > demo/heart/recipe.toml
	$(HEARTGEN) build demo/heart/recipe.toml --ct "$(SCAN)" --atlas "$(ATLAS)" --output demo/heart/bundle --force
	rm -f $(RELEASED)-heart.tar.zst && $(HEARTGEN) pack demo/heart/bundle $(RELEASED)-heart.tar.zst
	packaging/pack_exports $(HEARTGEN) demo/heart/bundle $(RELEASED)-heart-exports.tar.zst
	cd dist && sha256sum heartgen-$(VERSION)-heart.tar.zst > heartgen-$(VERSION)-heart.tar.zst.sha256
endif
release: deb tarball demo/bundle.tar.zst
	git archive --prefix=heartgen-$(VERSION)/ HEAD | gzip -9n > $(RELEASED).tar.gz
	cp demo/bundle.tar.zst $(RELEASED)-phantom.tar.zst
	packaging/pack_exports $(HEARTGEN) demo/bundle $(RELEASED)-phantom-exports.tar.zst
	cd dist && sha256sum heartgen-$(VERSION)-phantom.tar.zst > heartgen-$(VERSION)-phantom.tar.zst.sha256
	cd dist && sha256sum *.deb *.tar.gz *.tar.zst > SHA256SUMS
	@ls -l dist; cat dist/SHA256SUMS

first-minutes: deb tarball demo/bundle.tar.zst build/chroot.stamp
	tests/chroot/first_minutes.sh dist demo/bundle.tar.zst build/chroot/system

test: $(BUILD)/build.ninja
	cmake --build --preset release --parallel $(JOBS)
	ctest --preset release

# The demo's exports in the programs that read them, which it installs.
build/%.stamp: .ci/install-packages
	.ci/install-packages $*
	@mkdir -p build && touch $@

test-clients: demo/bundle/manifest.json build/clients.stamp
	rm -rf demo/clients
	$(HEARTGEN) export demo/bundle --to $(CLIENT_FORMATS) --output demo/clients
	$(HEARTGEN) export demo/bundle --to msh2,msh-ascii --no-interfaces --output demo/clients/outer
	/usr/bin/python3 tests/clients/check_exports.py demo/bundle demo/clients
	/usr/bin/python3 tests/clients/reader_rules.py demo/clients
	/usr/bin/python3 tests/clients/run_decks.py demo/clients demo/bundle
	/usr/bin/python3 tests/clients/pacing.py demo/clients stops
	/usr/bin/python3 tests/clients/check_report.py demo/bundle/validation/report.html

# The same bits on other processors, vector instructions, threads, processes and BLAS.
test-machines: $(HEARTGEN) build/machines.stamp
	tests/machines/same_bits.sh $(HEARTGEN)

# Kills, full disks, missing rights and memory: what a build leaves. Not a part of `make test`.
KILLS := 100
chaos: $(HEARTGEN)
	/usr/bin/python3 tests/chaos/chaos.py $(HEARTGEN) --kills $(KILLS)

# Speeds of the image stages on this machine; the last one on two processes.
bench: lab
	$(LAB) bench sweep segment epicardium
	OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun -n 2 $(LAB) bench ranks

# Rooms of the house and the arrows between them (cmake/rooms.cmake).
rooms: $(BUILD)/build.ninja
	@cmake --build --preset release --target test_architecture > /dev/null
	@$(BUILD)/bin/test_architecture --gtest_filter=Rooms.ArrowsAreTheDeclaredOnes --gtest_brief=1

asan: build/packages.stamp
	cmake --preset asan
	cmake --build --preset asan --parallel $(JOBS)
	ctest --preset asan

tsan: build/packages.stamp
	cmake --preset tsan
	cmake --build --preset tsan --parallel $(JOBS)
	ctest --preset tsan

# What libFuzzer finds new stays in build/fuzz/corpus; what a reader does not survive, in build/fuzz/KIND-crash-*.
fuzz: build/fuzz.stamp
	cmake --preset fuzz
	cmake --build --preset fuzz --parallel $(JOBS)
	@for kind in $(FUZZ_KINDS); do \
	  echo "fuzz: $$kind, $(FUZZ_SECONDS) s"; mkdir -p build/fuzz/corpus/$$kind; \
	  LSAN_OPTIONS=suppressions=tests/third_party_leaks.txt:print_suppressions=0 \
	  build/fuzz/bin/fuzz_readers --kind=$$kind -max_total_time=$(FUZZ_SECONDS) -timeout=60 -rss_limit_mb=4096 \
	    -artifact_prefix=build/fuzz/$$kind- build/fuzz/corpus/$$kind tests/fuzz/corpus/$$kind \
	    > build/fuzz/$$kind.log 2>&1 || { tail -40 build/fuzz/$$kind.log; exit 1; }; \
	done

format:
	clang-format -i $$(git ls-files '*.hpp' '*.cpp')

# The documentation as a site that opens from disk, in build/docs/html.
docs: build/docs.stamp program
	cmake --build --preset release --parallel $(JOBS) --target heartgen_default_recipe
	/usr/bin/python3 docs/site/build.py $(HEARTGEN) $(BUILD)/bin/heartgen_default_recipe build/docs
	/usr/bin/python3 docs/site/check_site.py build/docs/html
	@echo "Open build/docs/html/index.html"

# Format, and headers that compile alone.
check: $(BUILD)/build.ninja
	clang-format --dry-run --Werror $$(git ls-files '*.hpp' '*.cpp')
	.ci/check-headers $(BUILD)

# clang-tidy on what differs from BASE (default: the last commit).
BASE := HEAD~1
tidy: $(BUILD)/build.ninja
	git diff --name-only --diff-filter=d $(BASE) -- '*.cpp' | xargs -r -P $(JOBS) -n 1 clang-tidy -quiet -p $(BUILD)

clean:
	rm -rf dist $(BUILD) build/asan build/tsan build/fuzz demo
