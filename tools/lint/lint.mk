# Formatting and static analysis. Included by the top Makefile, last.

CPP_FILES := $(shell find firmware hal host_sim nn tools tests boards -name '*.cpp' -o -name '*.h' | LC_ALL=C sort)
TIDY_SOURCES := $(sort $(ALL_HOST_SOURCES))

# Sources whose object, flags or checks changed since they were last found clean, as many at a time as go together.
.PHONY: lint check-format format
lint: check-format check-telemetry-page $(call objects,$(TIDY_SOURCES)) $(B)/lint.flags  ## formatting and static analysis
	@tools/lint/run.sh $(B) $(TIDY_SOURCES)
	@echo "lint: $(words $(TIDY_SOURCES)) sources clean"
check-format:
	@clang-format --dry-run -Werror $(CPP_FILES)
format:  ## clang-format over the tree
	clang-format -i $(CPP_FILES)
$(B)/lint.flags: $(B)/host.flags | $(B)/tiny_dnn/third_party/stb
	@echo "$$(cat $<) -idirafter $(B)/tiny_dnn $(RSVG_FLAGS) $(SDL_FLAGS)" > $@

# One of them.
$(B)/%.tidy: %.cpp $(B)/%.o $(B)/firmware.flags $(B)/lint.flags .clang-tidy
	@tools/lint/run.sh $(B) $<
