# Unit tests, software-in-the-loop tests, tests of the microcontroller's images, and the long ones of all these.
# Included by the top Makefile after the parts whose tests it runs; parts with tests of their own add to TESTS and
# TEST_IMAGES, or to what `test` needs.
#
# tests/unit mirrors the folders of the sources. A test of more than two seconds lies in tests/long, whose program `make
# test` neither compiles nor links.

UNIT_SOURCES := $(call sources,tests/unit)
SITL_SOURCES := $(call sources,tests/sitl)
LONG_SOURCES := $(filter-out tests/long/mcu/%,$(call sources,$(wildcard tests/long)))
SCHEMA_LIBRARY_SOURCES := $(filter-out tools/schema/main.cpp,$(call sources,tools/schema))
LAB_LIBRARY_SOURCES := $(filter-out tools/bench/telemetry/main.cpp,$(call sources,tools/bench/telemetry))
TESTS := $(B)/tests/unit_tests $(B)/tests/sitl_tests
LONG_TESTS := $(B)/tests/long_tests

# ---- programs --------------------------------------------------------------------------------------------------------

$(eval $(call in_groups,UNIT,$(UNIT_SOURCES),test))
$(eval $(call in_groups,SITL,$(SITL_SOURCES),test))
$(eval $(call in_groups,LONG,$(LONG_SOURCES),test))
ifeq ($(MCU),yes)
include tests/mcu/mcu_tests.mk
endif

TEST_LIBRARIES = $$(pkg-config --libs $(TEST_PACKAGES))
# The library stands first, and whole: tests are compiled without optimising, and of an inline function that both have
# compiled the linker takes the first it meets.
define link_tests
	@echo "  LINK $@"
	@$(CXX) -Wl,--whole-archive $(LIBRARY) -Wl,--no-whole-archive $(filter-out $(LIBRARY),$(filter %.o %.a,$^)) \
	  -Wl,--as-needed \
	  @$(B)/link.flags $(TEST_LIBRARIES) -o $@
	$(call runnable,$@)
endef
# What tests are linked with.
TESTED := $(call objects,$(SCHEMA_LIBRARY_SOURCES) $(LAB_LIBRARY_SOURCES)) $(LIBRARY) $(B)/libavr_tools.a
$(B)/tests/unit_tests: $(UNIT_OBJECTS) $(TESTED) $(B)/link.flags
	$(call link_tests)
$(B)/tests/sitl_tests: $(SITL_OBJECTS) $(LIBRARY) $(B)/link.flags
	$(call link_tests)
$(LONG_TESTS): $(LONG_OBJECTS) $(MCU_LONG_PARTS) $(TESTED) $(B)/link.flags
	$(call link_tests)

# Every host source that is compiled with the host's flags or the firmware's: what lint and clangd look at.
ALL_HOST_SOURCES = $(LIBRARY_SOURCES) tools/screed/main.cpp \
  $(call sources,tools/avr tools/schema tools/bench tools/mutants tests/unit tests/sitl tests/portable) $(LONG_SOURCES)

# Expanded twice: later parts add their tests.
.SECONDEXPANSION:
.PHONY: test test-long
test:  ## build and run the tests that take seconds (BUILD=asan: under the sanitizers)
test: $(SCREED) $$(TESTS) $$(TEST_IMAGES)
	@SCREED_PROGRAM=$(abspath $(SCREED)) tests/run.sh $(TESTS)
test-long:  ## build and run those that take longer: long drives, whole runs, minutes of the microcontroller
test-long: $(SCREED) $(LONG_TESTS) $$(TEST_IMAGES)
	@SCREED_PROGRAM=$(abspath $(SCREED)) tests/run.sh $(LONG_TESTS)

# The tests of single sources: quick to build, for whoever works on them. Which ones, no date of a file says: linked
# each time.
.PHONY: test-file test-tutorial
# The tutorial comes last: it changes the tree.
TUTORIALS := soil-library world-library python looking-at-runs tutorial
test-file:  ## build and run single tests (TEST='tests/unit/firmware/leveling/*_test.cpp')
test-file: $(SCREED) $(B)/tests/test_file
	@SCREED_PROGRAM=$(abspath $(SCREED)) $(B)/tests/test_file $(ARGS)
$(B)/tests/test_file: $(call objects,$(wildcard $(TEST)) $(filter-out %_test.cpp,$(UNIT_SOURCES))) $(TESTED) \
  $(B)/link.flags FORCE
	$(if $(wildcard $(TEST)),,$(error TEST='FILE...' names sources of tests; there is none of the name '$(TEST)'))
	$(call link_tests)
test-tutorial: $(SCREED)  ## the commands of the tutorial and of four other pages, in a copy of the tree
	@tests/docs/tutorial.sh $(TUTORIALS:%=docs/%.md)

.PHONY: test-install
test-install: $(SCREED) $(REPORT_PAGE) $(INTERFACE_LIBRARIES)  ## install, move the tree, run it from elsewhere
	@tests/install/run.sh
