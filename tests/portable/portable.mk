# The portable core, and worlds of particles beside it, with nothing but a compiler and Eigen, on 64-bit Arm and here:
# the same bits. Included by the top Makefile.
#
# The core is what C, Python, a browser or another simulator can take over: firmware, its HAL, the stand-in on soil, the
# robots' devices, the measures of leveling. It opens no file, starts no thread and knows no library but lemon's
# headers.

PORTABLE := $(BUILD_ROOT)/portable
PORTABLE_CXX := aarch64-linux-gnu-g++ -std=c++20 $(COMMON_FLAGS) -Wno-psabi -idirafter /usr/include/eigen3 \
  -idirafter $(PORTABLE)/include
PORTABLE_CORE_ALONE := core/elementary core/nimh_cell core/record core/lanes/instruction_set \
  physics/world/wall_clearance ground_station/telemetry/candump_line \
  $(addprefix ground_station/station/,command_key ground_station) run/world/world run/world/without_simavr
PORTABLE_CORE_FOLDERS := firmware $(patsubst %/,%,$(wildcard firmware/*/)) nn/infer hal/host \
  $(addprefix host_sim/,devices/sensors devices/radio leveling standin physics/kernels physics/soil physics/terrain \
  physics/vehicle)
PORTABLE_CORE_SOURCES := $(PORTABLE_CORE_ALONE:%=host_sim/%.cpp) $(wildcard $(PORTABLE_CORE_FOLDERS:%=%/*.cpp))
PORTABLE_CORE_SOURCES := $(filter-out %avx2.cpp %avx512.cpp %/grey_image.cpp %/elevation_file.cpp %/ode_world.cpp \
  %/vehicle.cpp %/model_report.cpp,$(PORTABLE_CORE_SOURCES))
PARTICLE_SOURCES := $(filter-out %avx2.cpp %avx512.cpp,$(wildcard host_sim/physics/particles/*.cpp))
# A folder is compiled as one, but for those whose helpers are called alike.
PORTABLE_ALONE := $(wildcard firmware/leveling/*.cpp) host_sim/physics/particles/bed_kernel_scalar.cpp
PORTABLE_TOGETHER := $(filter-out $(PORTABLE_ALONE),$(PORTABLE_CORE_SOURCES) $(PARTICLE_SOURCES))
portable_objects = $(patsubst %.cpp,$(PORTABLE)/%.o,$(filter $(PORTABLE_ALONE),$(1))) \
  $(patsubst %/,$(PORTABLE)/%/all.o,$(sort $(dir $(filter-out $(PORTABLE_ALONE),$(1)))))
PORTABLE_CORE_OBJECTS := $(call portable_objects,$(PORTABLE_CORE_SOURCES))
PARTICLE_OBJECTS := $(call portable_objects,$(PARTICLE_SOURCES))
PORTABLE_PROGRAMS := $(PORTABLE)/core $(PORTABLE)/particles
# What the core must not ask for, as symbols.
NOT_PORTABLE := pthread_create|std::thread|std::filesystem|basic_(i|o|)fstream|basic_filebuf|fopen
NOT_PORTABLE := $(NOT_PORTABLE)|dWorld|dBody|H5[A-Z]|CLI::|avr_

$(PORTABLE)/%.o: %.cpp | $(SCHEMA_HEADERS)
	@mkdir -p $(@D)
	@echo "  CXX  $< for arm64"
	@$(PORTABLE_CXX) -MMD -MP -c $< -o $@
# Written anew when a source joins or leaves the folder.
$(PORTABLE)/%/all.cpp: FORCE
	@mkdir -p $(@D)
	@printf '#include "%s"\n' $(filter $(wildcard $*/*.cpp),$(PORTABLE_TOGETHER)) | $(WRITE_CHANGED)
$(PORTABLE)/%/all.o: $(PORTABLE)/%/all.cpp | $(SCHEMA_HEADERS)
	@echo "  CXX  $* for arm64"
	@$(PORTABLE_CXX) -Wno-subobject-linkage -MMD -MP -c $< -o $@
.PRECIOUS: $(PORTABLE)/%/all.cpp
# Lemon's headers alone: all of /usr/include would be this machine's C library.
$(PORTABLE)/include/lemon:
	@mkdir -p $(@D)
	@ln -sfn /usr/include/lemon $@
$(PORTABLE_CORE_OBJECTS) $(PARTICLE_OBJECTS) $(PORTABLE_PROGRAMS:$(PORTABLE)/%=$(PORTABLE)/tests/portable/%.o): | \
  $(PORTABLE)/include/lemon
$(PORTABLE)/particles: $(PARTICLE_OBJECTS)
$(PORTABLE_PROGRAMS): $(PORTABLE)/%: $(PORTABLE)/tests/portable/%.o $(PORTABLE_CORE_OBJECTS)
	@aarch64-linux-gnu-g++ $^ -o $@
$(B)/tests/portable_%: $(B)/tests/portable/%.o $(LIBRARY) $(B)/link.flags
	$(call link)

.PHONY: test-portable
test-portable:  ## the portable core needs nothing but a compiler, and has the same bits on 64-bit Arm as here
test-portable: $(B)/tests/portable_core $(B)/tests/portable_particles $(PORTABLE_PROGRAMS)
	@! aarch64-linux-gnu-nm -C --undefined-only $(PORTABLE_CORE_OBJECTS) | \
	  grep -E '$(NOT_PORTABLE)' || { echo 'test-portable: the core asks for the symbols above' >&2; exit 1; }
	@{ $(B)/tests/portable_core; $(B)/tests/portable_particles; } > $(PORTABLE)/here
	@for it in $(PORTABLE_PROGRAMS); do qemu-aarch64 -L /usr/aarch64-linux-gnu $$it; done | \
	  diff $(PORTABLE)/here - || { echo 'test-portable: on 64-bit Arm (>) other bits than here (<)' >&2; exit 1; }
	@cat $(PORTABLE)/here
	@echo "$$(wc -l < $(PORTABLE)/here) passed, 0 failed"
