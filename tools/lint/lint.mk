# Formatting and static analysis. Included by the top Makefile, last.

CPP_FILES := $(shell find firmware hal host_sim nn tools tests boards -name '*.cpp' -o -name '*.h' -o -name '*.c' | \
  LC_ALL=C sort)
# clang does not know what watchdog.cpp and reset_cause.cpp are made of: instructions of avr-libc's wdt.h, a naked
# function in C++.
AVR_TIDY_SOURCES := $(filter-out hal/avr/watchdog.cpp hal/avr/reset_cause.cpp,$(call sources,hal/avr))

# clang-tidy looks at some sixty sources at a time (tools/lint/units.awk), again when one of their objects is new.
# $(call tidy_set,SET,SOURCES ALONE AND GROUPS,FLAGS,CHECKS): SET_TIDY are the stamps.
tidy_sources = $(subst $(comma), ,$(lastword $(subst :, ,$(1))))
tidy_stamp = $(B)/tidy/$(1)/$(subst /,-,$(basename $(firstword $(call tidy_sources,$(2))))).tidy
define tidy_set
$(1)_UNITS := $$(shell printf '%s\n' $(2) | awk -v build=$(B) -v folder=$(B)/groups/$(1) -f tools/lint/units.awk)
$(1)_TIDY := $$(foreach unit,$$($(1)_UNITS),$$(call tidy_stamp,$(1),$$(unit)))
$$(foreach unit,$$($(1)_UNITS),$$(eval $$(call tidy_unit,$$(call tidy_stamp,$(1),$$(unit)),$$(subst $$(comma), ,\
$$(firstword $$(subst :, ,$$(unit)))),$$(call tidy_sources,$$(unit)),$(3),$(4))))
endef
define tidy_unit
$(1): $(2) $(B)/$(4).flags .clang-tidy tools/lint/tidy.sh tools/lint/paste.awk
	@tools/lint/tidy.sh $$@ $(B)/$(4).flags '$(5)' $(3)
endef
# Tests are straight-line code with small indices: without the analyser and without the widening of products.
TEST_CHECKS := -clang-analyzer-*$(comma)-bugprone-implicit-widening-of-multiplication-result
OTHER_SOURCES := $(call sources,tools/avr tools/schema tools/bench tools/mutants tests/portable)
$(eval $(call tidy_set,CORE,$(CORE_SOURCES),firmware))
# What gives its lanes the same names as another of them goes alone.
LANES := $(wildcard $(addprefix host_sim/physics/,kernels/avx*.cpp kernels/baseline.cpp particles/bed_kernel_*.cpp))
$(eval $(call tidy_set,HOT,$(HOT_GROUPS) $(filter-out $(LANES),$(HOT_ALONE)),lint))
$(foreach source,$(LANES),$(eval $(call tidy_set,$(basename $(notdir $(source))),$(source),lint)))
$(eval $(call tidy_set,COLD,$(COLD_GROUPS) $(COLD_ALONE) tools/screed/main.cpp,lint))
$(eval $(call tidy_set,OTHER,$(OTHER_SOURCES),lint))
TIDY := $(CORE_TIDY) $(HOT_TIDY) $(foreach source,$(LANES),$($(basename $(notdir $(source)))_TIDY)) $(COLD_TIDY) \
  $(OTHER_TIDY)
define tidy_tests
$(call tidy_set,$(1),$($(1)_GROUPS) $($(1)_ALONE),$(2),$$(TEST_CHECKS))
TIDY += $$($(1)_TIDY)
endef
$(foreach set,UNIT SITL LONG,$(eval $(call tidy_tests,$(set),lint)))
$(foreach set,MCU MCU_LONG,$(eval $(call tidy_tests,$(set),mcu_tests)))
# What has no object of the host: one by one.
AVR_TIDY := $(AVR_TIDY_SOURCES:%.cpp=$(B)/tidy/%.tidy)
$(AVR_TIDY): $(B)/tidy/%.tidy: %.cpp $(FIRMWARE_BUILD)/%.o $(B)/avr.flags .clang-tidy
	@tools/lint/tidy.sh $@ $(B)/avr.flags '' $<

# Checks of a moment come first.
.PHONY: lint check check-format check-includes check-words check-root check-one-source check-pages format
check: check-root check-format check-includes check-words check-one-source check-pages check-pictures \
  check-telemetry-page
check:  ## formatting, layers, words, links: the checks of seconds
lint: check $(TIDY) $(AVR_TIDY)  ## the same and static analysis
	@echo "lint: clean"
check-root:
	@tools/lint/check_root.sh
check-format:
	@clang-format --dry-run -Werror $(CPP_FILES)
	@tools/lint/long_lines.sh
check-includes:
	@tools/lint/include_graph.sh
check-words:
	@tools/lint/glossary.sh
check-one-source:
	@tools/lint/one_source.sh
	@tools/lint/one_class.sh
	@tools/lint/own_functions.sh
check-pages:
	@tools/lint/check_links.sh
	@tools/lint/check_pages.sh
format:  ## clang-format over the tree
	clang-format -i $(CPP_FILES)
# Without -Werror: compilers' warnings are the build's, by its compiler. (With the analyser among its checks clang-tidy
# takes no notice of it anyway.) And without the parameters that GCC alone knows.
$(B)/lint.flags: $(B)/host.flags | $(B)/tiny_dnn/third_party/stb
	@echo "$$(sed 's/-Werror//; s/--param=[^ ]*//' $<) -idirafter $(B)/tiny_dnn $(RSVG_FLAGS) $(SDL_FLAGS)" > $@
# Flags are taken as they stand, by no shell: without the quotes that keep the others from one.
$(B)/mcu_tests.flags: $(B)/lint.flags $(B)/tests/mcu.flags
	@cat $^ | tr -d "'" > $@
# gcc-avr's own flags are not clang's.
$(B)/avr.flags: FORCE
	@mkdir -p $(@D)
	@echo "--target=avr -mmcu=$(BOARD_MCU) -Os -D__HAS_DELAY_CYCLES=1 -std=c++14 -DF_CPU=$(BOARD_CLOCK_HZ)UL \
	  -D__STDC_LIMIT_MACROS -D__STDC_CONSTANT_MACROS $(AVR_INCLUDES) -isystem /usr/lib/avr/include \
	  -isystem $(ARDUINO_CORE) -isystem $(ARDUINO_VARIANT)" | $(WRITE_CHANGED)
