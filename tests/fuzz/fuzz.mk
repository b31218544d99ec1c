# Fuzzing of everything that reads bytes from outside, by clang's libFuzzer under ASan and UBSan. Included by the top Makefile.
#
#   make fuzz [EXECUTIONS=...]   so many executions of each target tests/fuzz/*_fuzz.cpp
#
# Starts from tests/fuzz/corpus/<target>; what it finds on the way stays in build/fuzz/corpus. An input that breaks a target is kept
# as build/fuzz/<target>-crash-... (or -timeout-, -oom-), and the run fails.
#
# Needs from there: BUILD_ROOT, STEP, DEPS, SCHEMA_HEADERS, SCHEMA_LIBRARY_SOURCES, GENERATED_FOLDER.

EXECUTIONS ?= 200000
FUZZ_CXX ?= clang++
FUZZ_BUILD := $(BUILD_ROOT)/fuzz
FUZZ_TARGETS := $(patsubst tests/fuzz/%.cpp,%,$(wildcard tests/fuzz/*_fuzz.cpp))
FUZZ_PROGRAMS := $(FUZZ_TARGETS:%=$(FUZZ_BUILD)/%)
FUZZ_LIBRARY_SOURCES := $(wildcard firmware/telemetry/slcan.cpp firmware/telemetry/e2e.cpp host_sim/link/xbee_api.cpp) \
  $(addprefix host_sim/telemetry/,schema.cpp candump_log.cpp log_decoder.cpp) $(SCHEMA_LIBRARY_SOURCES)
FUZZ_LIBRARY_OBJECTS := $(FUZZ_LIBRARY_SOURCES:%.cpp=$(FUZZ_BUILD)/%.o)
FUZZ_FLAGS := -std=c++20 -O2 -g -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer \
  -I. -I$(GENERATED_FOLDER)

.PHONY: fuzz run-fuzz
fuzz: deps
	@tools/install-deps.sh $(DEPS) tests/fuzz/debian-packages.txt
	$(STEP) run-fuzz
run-fuzz: $(FUZZ_PROGRAMS)
	@tests/fuzz/run.sh $(FUZZ_BUILD) $(EXECUTIONS) $(FUZZ_TARGETS)

# -fsanitize=fuzzer-no-link: the code counts its ways, without the fuzzer's main().
$(FUZZ_BUILD)/%.o: %.cpp tests/fuzz/fuzz.mk | $(SCHEMA_HEADERS)
	@mkdir -p $(@D)
	@echo "  FUZZ $<"
	@$(FUZZ_CXX) $(FUZZ_FLAGS) -fsanitize=fuzzer-no-link -MMD -MP -c $< -o $@
$(FUZZ_PROGRAMS): $(FUZZ_BUILD)/%: $(FUZZ_BUILD)/tests/fuzz/%.o $(FUZZ_LIBRARY_OBJECTS)
	@$(FUZZ_CXX) $(FUZZ_FLAGS) -fsanitize=fuzzer $^ -o $@
.SECONDARY: $(FUZZ_TARGETS:%=$(FUZZ_BUILD)/tests/fuzz/%.o)

-include $(FUZZ_LIBRARY_OBJECTS:.o=.d) $(FUZZ_TARGETS:%=$(FUZZ_BUILD)/tests/fuzz/%.d)
