# `make surrogate`: the thesis' training sessions, networks V1 and V2 trained on them, evaluated, quantised, exported. Results in out/.
#
#   make surrogate FRAMES=4000 ARGS='--epochs 2'    a short run of everything
#   make surrogate MODELS=v1                        one of nn/configurations
#
# Sessions that are there already are not recorded again. Needs from the top Makefile: SCREED, OUT, STEP.

MODELS ?= v1 v2 v2_tuned v2_products v2_forward v2_gyro
SURROGATE_SESSIONS ?= $(sort $(wildcard host_sim/data/experiments/sessions/v1_*.ini host_sim/data/experiments/sessions/v2_*.ini))

.PHONY: surrogate run-surrogate
surrogate: deps
	$(STEP) run-surrogate
run-surrogate: $(SCREED)
	@set -e ; for file in $(SURROGATE_SESSIONS) ; do session=$(OUT)/sessions/$$(basename $$file .ini) ; \
	  ls $$session/session.h5 $$session-[0-9]*/session.h5 > /dev/null 2>&1 || \
	    $(SCREED) record $$file --out $$session $(if $(FRAMES),--frames $(FRAMES)) ; done
	@set -e ; for model in $(MODELS) ; do \
	  echo "== $$model" ; \
	  $(SCREED) nn train nn/configurations/$$model.json --sessions $(OUT)/sessions --out $(OUT)/nn/$$model $(ARGS) ; \
	  $(SCREED) nn eval $(OUT)/nn/$$model/model.json nn/configurations/$$model.json --sessions $(OUT)/sessions \
	    --out $(OUT)/nn/$$model/charts > $(OUT)/nn/$$model/evaluation.txt ; \
	  $(SCREED) nn check $(OUT)/nn/$$model/model.json --vectors 100000 ; \
	  $(SCREED) nn export $(OUT)/nn/$$model/model.json --header $(OUT)/nn/$$model/model.h ; done
