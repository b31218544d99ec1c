# Tests against NumPy and SciPy: what the program computes, once more by others. Included by the top Makefile.

.PHONY: test-python
test-python: $(SCREED) $(INTERFACE_SHARED)  ## metrics of recorded runs against an implementation in NumPy and SciPy
	@SCREED_PROGRAM=$(abspath $(SCREED)) tests/python/run.sh
