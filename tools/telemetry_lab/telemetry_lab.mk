# Measurements of the telemetry that need much data. Included by the top Makefile.
#
#   make bench-decode [FRAMES=...]   frames a second of `screed decode`, beside tshark on the same log
#   make damage [LINES=...]          wrong frames that damaged lines bring forth
#
# Needs from there: B, SCREED, LIBRARY, STEP, objects, GENERATED_FOLDER.

LINES ?= 10000000
TELEMETRY_LAB := $(B)/telemetry_lab

.PHONY: bench-decode run-bench-decode damage run-damage
bench-decode: deps
	$(STEP) run-bench-decode
damage: deps
	$(STEP) run-damage

run-bench-decode: $(SCREED) $(TELEMETRY_LAB)
	@tools/telemetry_lab/bench_decode.sh $(SCREED) $(TELEMETRY_LAB) $(GENERATED_FOLDER)/wireshark $(or $(FRAMES),1000000)
run-damage: $(TELEMETRY_LAB)
	@$(TELEMETRY_LAB) damage $(LINES)

$(TELEMETRY_LAB): $(B)/tools/telemetry_lab/main.o $(call objects,$(LAB_LIBRARY_SOURCES)) $(LIBRARY) $(B)/link.flags
	@echo "  LINK $@"
	@$(CXX) $(filter %.o %.a,$^) -Wl,--as-needed @$(B)/link.flags -o $@
