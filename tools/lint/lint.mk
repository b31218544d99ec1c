# Formatting and static analysis. Included by the top Makefile, last.

CPP_FILES := $(shell find firmware hal host_sim nn tools tests boards -name '*.cpp' -o -name '*.h' | LC_ALL=C sort)
# clang does not know what watchdog.cpp and reset_cause.cpp are made of: instructions of avr-libc's wdt.h, a naked function in C++.
AVR_TIDY_SOURCES := $(filter-out hal/avr/watchdog.cpp hal/avr/reset_cause.cpp,$(call sources,hal/avr))
HOST_TIDY_SOURCES := $(sort $(ALL_HOST_SOURCES) $(MCU_TEST_SOURCES) $(MCU_LONG_SOURCES))

# Checks of a moment come first; then clang-tidy over sources whose object, flags or checks changed since they were last found clean,
# as many at a time as go together.
.PHONY: lint check-format check-includes check-words check-root check-one-source check-links format
lint: check-root check-format check-includes check-words check-one-source check-links check-telemetry-page $(call objects,$(HOST_TIDY_SOURCES)) $(B)/lint.flags $(B)/mcu_tests.flags $(B)/avr.flags \
      $(FIRMWARE_BUILD)/generated/build_info.h  ## formatting, layers, words, static analysis
	@tools/lint/run.sh $(B) $(HOST_TIDY_SOURCES) $(AVR_TIDY_SOURCES)
	@echo "lint: $(words $(HOST_TIDY_SOURCES) $(AVR_TIDY_SOURCES)) sources clean"
check-root:
	@tools/lint/check_root.sh
check-format:
	@clang-format --dry-run -Werror $(CPP_FILES)
check-includes:
	@tools/lint/include_graph.sh
check-words:
	@tools/lint/glossary.sh
check-one-source:
	@tools/lint/one_source.sh
	@tools/lint/one_class.sh
check-links:
	@tools/lint/check_links.sh
format:  ## clang-format over the tree
	clang-format -i $(CPP_FILES)
# Without -Werror: compilers' warnings are the build's, by its compiler. (With the analyser among its checks clang-tidy takes no
# notice of it anyway.)
$(B)/lint.flags: $(B)/host.flags | $(B)/tiny_dnn/third_party/stb
	@echo "$$(sed 's/-Werror//' $<) -idirafter $(B)/tiny_dnn $(RSVG_FLAGS) $(SDL_FLAGS)" > $@
# Flags are taken as they stand, by no shell: without the quotes that keep the others from one.
$(B)/mcu_tests.flags: $(B)/lint.flags $(B)/tests/mcu.flags
	@cat $^ | tr -d "'" > $@
# gcc-avr's own flags are not clang's.
$(B)/avr.flags: FORCE
	@mkdir -p $(@D)
	@echo "--target=avr -mmcu=$(BOARD_MCU) -Os -D__HAS_DELAY_CYCLES=1 -std=c++14 -DF_CPU=$(BOARD_CLOCK_HZ)UL -D__STDC_LIMIT_MACROS -D__STDC_CONSTANT_MACROS \
	  $(AVR_INCLUDES) -isystem /usr/lib/avr/include -isystem $(ARDUINO_CORE) -isystem $(ARDUINO_VARIANT)" | $(WRITE_CHANGED)

# One of them.
$(B)/%.tidy: %.cpp $(B)/%.o $(B)/firmware.flags $(B)/lint.flags .clang-tidy
	@tools/lint/run.sh $(B) $<
