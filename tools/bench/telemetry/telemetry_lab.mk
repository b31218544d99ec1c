# Measurements of the telemetry that need much data. Included by the top Makefile.
#
# Needs host.mk and tests/tests.mk.

LINES ?= 10000000
TELEMETRY_LAB := $(B)/telemetry_lab

.PHONY: bench-decode damage
bench-decode: $(SCREED) $(TELEMETRY_LAB)  ## frames a second of screed decode, beside tshark (FRAMES=1000000)
	@tools/bench/telemetry/bench_decode.sh $(SCREED) $(TELEMETRY_LAB) $(GENERATED_FOLDER)/wireshark $(or $(FRAMES),1000000)
damage: $(TELEMETRY_LAB)  ## wrong frames that damaged lines of the radio bring forth (LINES=10000000)
	@$(TELEMETRY_LAB) damage $(LINES)

$(TELEMETRY_LAB): $(B)/tools/bench/telemetry/main.o $(call objects,$(LAB_LIBRARY_SOURCES)) $(LIBRARY) $(B)/link.flags
	$(call link)
