# Keys at the ends of their ranges, and pairs of keys, in every world. Included by the top Makefile.

.PHONY: limits test-limits
limits: $(SCREED)  ## keys at the ends of their ranges in every world, and 300 pairs of them (ARGS='--world soil')
	@python3 -B tests/limits/limits.py $(SCREED) --jobs $(shell nproc) $(ARGS)

test-limits: $(SCREED)
	@echo "  TEST tests/limits"
	@python3 -B tests/limits/limits.py $(SCREED) --jobs $(shell nproc) --sample 60 --pairs 20 --memory-step 30
test-long: test-limits
