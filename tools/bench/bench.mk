# Benchmarks. Included by the top Makefile.

TERRAIN_BENCH_SOURCES := $(call sources,tools/bench/terrain)

$(B)/bench: $(call objects,$(call sources,tools/bench/speed)) $(LIBRARY) $(B)/link.flags
	$(call link,$$(pkg-config --libs $(BENCH_PACKAGES)) -lfixedfann)
$(B)/terrain_bench: $(call objects,$(TERRAIN_BENCH_SOURCES)) $(LIBRARY) $(B)/link.flags
	$(call link)

.PHONY: bench bench-terrain soil-same-bits
bench: $(B)/bench $(SCREED)  ## real-time factor, ns per tick, throughput of campaigns
	@SCREED_PROGRAM=$(abspath $(SCREED)) $(B)/bench --benchmark_counters_tabular=true $(ARGS)
bench-terrain: $(B)/terrain_bench  ## time and memory of a frame on every terrain, beside the thesis'
	@$(B)/terrain_bench --out $(OUT)/bench-terrain $(ARGS)
soil-same-bits: $(SCREED)  ## soil and particles compiled with -O1 and -O3 leave the same bytes
	@tools/bench/soil_same_bits.sh $(B)
