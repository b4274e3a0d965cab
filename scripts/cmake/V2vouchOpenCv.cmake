# v2vouch::opencv: the four OpenCV libraries we use, and no more. Debian's OpenCVConfig.cmake comes
# with libopencv-dev only, which pulls in Qt and GTK; the single libraries need neither.
find_path(V2VOUCH_OPENCV_INCLUDE opencv2/dnn.hpp PATH_SUFFIXES opencv4 REQUIRED)
add_library(v2vouch_opencv INTERFACE)
target_include_directories(v2vouch_opencv SYSTEM INTERFACE "${V2VOUCH_OPENCV_INCLUDE}")
foreach(part dnn imgcodecs imgproc core)
  find_library(V2VOUCH_OPENCV_${part} opencv_${part} REQUIRED)
  target_link_libraries(v2vouch_opencv INTERFACE "${V2VOUCH_OPENCV_${part}}")
endforeach()
add_library(v2vouch::opencv ALIAS v2vouch_opencv)
