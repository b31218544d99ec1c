# Position fixes from a camera above the bed: an example that needs OpenCV. Included by the top Makefile.

SITE_CAMERA := $(B)/site_camera
SITE_CAMERA_TEST := $(B)/tests/site_camera_test
OPENCV_FLAGS := -isystem /usr/include/opencv4
OPENCV_LIBRARIES := -lopencv_aruco -lopencv_calib3d -lopencv_imgcodecs -lopencv_imgproc -lopencv_videoio -lopencv_core

.PHONY: camera test-camera
camera: $(SITE_CAMERA)  ## the example of position fixes from a webcam (needs OpenCV)
$(SITE_CAMERA): tools/camera/site_camera.cpp $(COMMAND_LINE) $(B)/host.flags
	@echo "  CXX  $<"
	@$(CXX) @$(B)/host.flags $(OPENCV_FLAGS) $(filter %.cpp %.o %.a,$^) -o $@ $(OPENCV_LIBRARIES)

$(B)/tests/camera/site_camera_test.o: tests/camera/site_camera_test.cpp $(B)/host.flags | $(GENERATED)
	@mkdir -p $(@D)
	@echo "  CXX  $<"
	@$(CXX) @$(B)/host.flags $(OPENCV_FLAGS) -MMD -MP -c $< -o $@
$(SITE_CAMERA_TEST): TEST_LIBRARIES += $(OPENCV_LIBRARIES)
$(SITE_CAMERA_TEST): $(B)/tests/camera/site_camera_test.o $(LIBRARY) $(B)/link.flags
	$(call link_tests)

test-camera:  ## it, with a calibrated lens, rendered frames of a run and a robot at a port
test-camera: $(SCREED) $(SITE_CAMERA) $(SITE_CAMERA_TEST)
	@SCREED_PROGRAM=$(abspath $(SCREED)) SITE_CAMERA_PROGRAM=$(abspath $(SITE_CAMERA)) tests/run.sh $(SITE_CAMERA_TEST)
