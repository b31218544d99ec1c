# Tests under the address and undefined-behaviour sanitizers. Included by the top Makefile.
#
# `make test-asan` runs the tests below: those whose code indexes memory with what comes from outside. Small enough for
# CI.
# `make test BUILD=asan` runs every test. Needs host.mk, tests/tests.mk and tests/mcu/mcu_tests.mk.

.PHONY: test-asan asan-tests
test-asan:  ## the tests of what reads foreign bytes, files and images, under the sanitizers
	+@$(MAKE) --no-print-directory BUILD=asan asan-tests

ifeq ($(BUILD),asan)

# clang instruments in two thirds of gcc's time, and with more checks. Warnings are for the release build, which gcc and
# clang-tidy see.
CXX := clang++
WARNINGS := -w

# Bytes of the radio and of a console; CAN frames; keys and parameters as an EEPROM holds them.
ASAN_UNIT := command command_key command_session corruption ground_station host_hal key_command \
  link parameters radio_link robot robot_downlink robot_history security protocol \
  supervisor supervisor_fault telemetry track_slip
# Files: logs, schemas, experiments, images, meshes, robots, sessions, models, listings of an image.
ASAN_UNIT += attitude_command avr_order avr_stack board_table candump_log content_hash decode \
  elevation_file experiment grey_image half_written height_field height_series ini_file json model_file network \
  picture run_folder schema schema_compiler session session_csv session_damage \
  session_replay urdf urdf_refusal urdf_roles urdf_body
# Grids that a position indexes.
ASAN_UNIT += footprint grid_world kernels material_digging material_flow particle_motion soil_bed soil_grid \
  shear_field soil_dig soil_interface soil_measurements soil_path soil_shear soil_laws
# The simulated board: registers, bus and USB, which an image writes as it likes.
ASAN_MCU := board_parts chips quadrature screed_image

ASAN_UNIT_SOURCES := $(foreach name,$(ASAN_UNIT),$(filter %/$(name)_test.cpp,$(UNIT_SOURCES))) \
  tests/unit/allocations.cpp
ASAN_MCU_SOURCES := $(ASAN_MCU:%=tests/mcu/%_test.cpp)
ASAN_THERE := $(notdir $(UNIT_SOURCES) $(MCU_TEST_SOURCES))
ASAN_MISSING := $(filter-out $(ASAN_THERE:%_test.cpp=%),$(ASAN_UNIT) $(ASAN_MCU))
ifneq ($(ASAN_MISSING),)
$(error tests/asan.mk: no such test: $(ASAN_MISSING))
endif

# The library without what none of these tests links: training, the surrogate, fits, campaigns, most subcommands,
# windows.
ASAN_COMMANDS := $(addprefix tools/screed/,link/attitude_command.cpp link/decode_command.cpp link/key_command.cpp \
  link/plot_command.cpp sim/replay_command.cpp cli/interrupt.cpp cli/number_option.cpp cli/progress_bar.cpp)
ASAN_LEFT_OUT := $(addprefix nn/,training/% terrain/% surrogate/% slip/% data/%) \
  $(addprefix host_sim/,search/% benchmark/% campaign/% \
  soil_validation/soil_fit.cpp soil_validation/wheel_limit.cpp soil_validation/wheel_testbed.cpp \
  soil_validation/plate_press.cpp)
ASAN_LIBRARY_SOURCES := $(ASAN_COMMANDS) $(COMMAND_LINE_SOURCES) \
  $(filter-out tools/% $(ASAN_LEFT_OUT),$(LIBRARY_SOURCES))
HOT_SOURCES := $(filter-out $(COLD_SOURCES),$(HOST_SOURCES))
$(eval $(call in_groups,ASAN_HOT,$(filter $(HOT_SOURCES),$(ASAN_LIBRARY_SOURCES)),host,,$(HOT_SOURCES)))
$(eval $(call in_groups,ASAN_COLD,$(filter $(COLD_SOURCES),$(ASAN_LIBRARY_SOURCES)),cold,,$(COLD_SOURCES)))
# Tools that these tests link beside the library: with the same compiled headers.
$(eval $(call with_headers,cold,$(call sources,tools/avr tools/schema tools/bench/telemetry)))
# Compiling takes longer than the tests: of what computes, what stands alone is optimised (soil, kernels, particles),
# groups are not.
$(ASAN_HOT_GROUP_OBJECTS): HEADER_SET = cold
$(ASAN_HOT_GROUP_OBJECTS): $(if $(filter yes,$(HEADERS)),$(B)/headers/cold.h.gch)
# Of an inline function that several have compiled the linker takes the first it meets: those that are optimised stand
# first.
ASAN_OPTIMISED := $(call objects,$(CORE_SOURCES) $(ASAN_HOT_ALONE)) $(ASAN_HOT_GROUP_OBJECTS)
$(B)/libasan_cold.a: $(ASAN_COLD_OBJECTS)
	@rm -f $@
	@ar rcs $@ $^

$(eval $(call in_groups,ASAN_UNIT,$(ASAN_UNIT_SOURCES),test))
$(eval $(call in_groups,ASAN_MCU,$(ASAN_MCU_SOURCES),test,@$(B)/tests/mcu.flags))
$(ASAN_MCU_GROUP_OBJECTS): $(B)/tests/mcu.flags
$(B)/tests/asan_unit_tests: $(ASAN_OPTIMISED) $(ASAN_UNIT_OBJECTS) \
  $(call objects,$(SCHEMA_LIBRARY_SOURCES) $(LAB_LIBRARY_SOURCES)) \
                            $(B)/libasan_cold.a $(B)/libavr_tools.a $(B)/link.flags
$(B)/tests/asan_mcu_tests: $(ASAN_OPTIMISED) $(ASAN_MCU_OBJECTS) $(MCU_BENCH) $(B)/libasan_cold.a $(B)/libavr_tools.a \
  $(B)/link.flags
ASAN_TESTS := $(B)/tests/asan_unit_tests $(if $(filter yes,$(MCU)),$(B)/tests/asan_mcu_tests)
$(ASAN_TESTS):
	$(call link,$(TEST_LIBRARIES))

# Figures of whole runs and of thousands of points, half of the time of all: they go through the code that the others of
# their files go through.
ASAN_LONG := GridFigures.*:SoilDigTest.MovesAsMuchAsAmongParticles:SoilDigTest.ALongSpinFindsGroundThatIsDense
ASAN_LONG := $(ASAN_LONG):SoilDigTest.ASpinOnASlopeCarriesMaterialDownhill:SoilDigTest.SlipCarriesAsFarAsAmongParticles
ASAN_LONG := $(ASAN_LONG):Footprint.ReachHoldsTheBody:Footprint.ReachBelow*:Footprint.LowestAtRim*
ASAN_IMAGES := $(addprefix $(FIRMWARE_BUILD)/,screed.elf screed.lst screed.size golden.elf)
asan-tests: $(ASAN_TESTS) $(if $(filter yes,$(MCU)),$(ASAN_IMAGES))
	@GTEST_FILTER='-$(ASAN_LONG)' tests/run.sh $(ASAN_TESTS)

endif
