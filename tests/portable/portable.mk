# Worlds with nothing but a compiler and Eigen, on 64-bit Arm and here: the same bits. Included by the top Makefile.
#
# What runs anywhere: soil, particles, the stand-in, and what these are made of. No ODE, no library but the compiler's.

PORTABLE := $(BUILD_ROOT)/portable
PORTABLE_CXX := aarch64-linux-gnu-g++ -std=c++20 $(COMMON_FLAGS) -Wno-psabi -idirafter /usr/include/eigen3
# A folder is compiled as one, but for the kernel of spheres, whose helpers are called as some of its neighbours.
PORTABLE_SOURCES := tests/portable/worlds.cpp $(wildcard host_sim/standin/*.cpp host_sim/physics/soil/*.cpp host_sim/physics/terrain/*.cpp) \
  $(wildcard host_sim/physics/vehicle/*.cpp host_sim/physics/kernels/*.cpp host_sim/physics/particles/*.cpp) host_sim/core/elementary.cpp \
  host_sim/core/nimh_cell.cpp host_sim/core/lanes/instruction_set.cpp host_sim/physics/world/terrain_factory.cpp host_sim/physics/world/wall_clearance.cpp
PORTABLE_SOURCES := $(filter-out %avx2.cpp %avx512.cpp %/grey_image.cpp %/ode_world.cpp %/vehicle.cpp %/model_report.cpp,$(PORTABLE_SOURCES))
PORTABLE_ALONE := $(filter %/bed_kernel_scalar.cpp,$(PORTABLE_SOURCES))
PORTABLE_TOGETHER := $(filter-out $(PORTABLE_ALONE),$(PORTABLE_SOURCES))
PORTABLE_OBJECTS := $(PORTABLE_ALONE:%.cpp=$(PORTABLE)/%.o) $(patsubst %/,$(PORTABLE)/%/all.o,$(sort $(dir $(PORTABLE_TOGETHER))))

$(PORTABLE)/%.o: %.cpp | $(SCHEMA_HEADERS)
	@mkdir -p $(@D)
	@echo "  CXX  $< for arm64"
	@$(PORTABLE_CXX) -MMD -MP -c $< -o $@
$(PORTABLE)/%/all.o: $$(filter $$(wildcard $$*/*.cpp),$(PORTABLE_TOGETHER)) | $(SCHEMA_HEADERS)
	@mkdir -p $(@D)
	@printf '#include "%s"\n' $^ > $(@D)/all.cpp
	@echo "  CXX  $* for arm64"
	@$(PORTABLE_CXX) -Wno-subobject-linkage -MMD -MP -c $(@D)/all.cpp -o $@
$(PORTABLE)/worlds: $(PORTABLE_OBJECTS)
	@aarch64-linux-gnu-g++ $^ -o $@
$(B)/tests/portable_worlds: $(B)/tests/portable/worlds.o $(LIBRARY) $(B)/link.flags
	$(call link)

.PHONY: test-portable
test-portable: $(B)/tests/portable_worlds $(PORTABLE)/worlds  ## worlds that need nothing but a compiler: on 64-bit Arm the same bits as here
	@$< > $(PORTABLE)/here
	@qemu-aarch64 -L /usr/aarch64-linux-gnu $(PORTABLE)/worlds | diff $(PORTABLE)/here - || { echo 'test-portable: on 64-bit Arm (>) other bits than here (<)' >&2; exit 1; }
	@cat $(PORTABLE)/here
	@echo "$$(wc -l < $(PORTABLE)/here) passed, 0 failed"
