# Fuzzing of everything that reads bytes from outside, by clang's libFuzzer under ASan and UBSan. Included by the top
# Makefile.
#
# Every tests/fuzz/*_fuzz.cpp is a target. It starts from tests/fuzz/corpus/<target>; what it finds on the way stays in
# build/fuzz/corpus. An input that breaks a target is kept as build/fuzz/<target>-crash-... (or -timeout-, -oom-), and
# the run fails.
#
# Needs schema.mk and tests/tests.mk.

EXECUTIONS ?= 200000
FUZZ_CXX ?= clang++
FUZZ_BUILD := $(BUILD_ROOT)/fuzz
FUZZ_TARGETS := $(patsubst tests/fuzz/%.cpp,%,$(wildcard tests/fuzz/*_fuzz.cpp))
FUZZ_PROGRAMS := $(FUZZ_TARGETS:%=$(FUZZ_BUILD)/%)
FUZZ_LIBRARY_SOURCES := firmware/protocol/slcan.cpp firmware/protocol/e2e.cpp \
  host_sim/ground_station/link/xbee_api.cpp \
  $(addprefix host_sim/ground_station/telemetry/,schema.cpp candump_line.cpp candump_log.cpp) \
  $(addprefix host_sim/core/,figures.cpp json.cpp json_text.cpp) \
  $(SCHEMA_LIBRARY_SOURCES)
FUZZ_LIBRARY_OBJECTS := $(FUZZ_LIBRARY_SOURCES:%.cpp=$(FUZZ_BUILD)/%.o)
FUZZ_FLAGS := -std=c++20 -O2 -g -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer \
  -I. -I$(GENERATED_FOLDER)

.PHONY: fuzz
fuzz: $(FUZZ_PROGRAMS)  ## fuzz everything that reads bytes (EXECUTIONS=200000)
	@tests/fuzz/run.sh $(FUZZ_BUILD) $(EXECUTIONS) $(FUZZ_TARGETS)

# -fsanitize=fuzzer-no-link: the code counts its ways, without the fuzzer's main().
$(FUZZ_BUILD)/%.o: %.cpp tests/fuzz/fuzz.mk | $(SCHEMA_HEADERS)
	@mkdir -p $(@D)
	@echo "  FUZZ $<"
	@$(FUZZ_CXX) $(FUZZ_FLAGS) -fsanitize=fuzzer-no-link -MMD -MP -c $< -o $@
$(FUZZ_PROGRAMS): $(FUZZ_BUILD)/%: $(FUZZ_BUILD)/tests/fuzz/%.o $(FUZZ_LIBRARY_OBJECTS)
	@$(FUZZ_CXX) $(FUZZ_FLAGS) -fsanitize=fuzzer $^ -o $@
.SECONDARY: $(FUZZ_TARGETS:%=$(FUZZ_BUILD)/tests/fuzz/%.o)
