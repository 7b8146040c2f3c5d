# The bus under full load beside the vendors' own peers (bus_speed.py), which have the IDL file and
# nothing of dyncal's sources. The full form is run by hand; the short one asserts that every block
# arrives, and in time.
add_library(bus_speed STATIC bus_speed/speed_end.c)
add_executable(bus_speed_end bus_speed/dyncal_end.cpp)
target_link_libraries(bus_speed_end PRIVATE dyncal_options bus_speed dyncal_bus)
if(DYNCAL_CYCLONE_DDS)
  find_package(CycloneDDS REQUIRED)
  add_executable(bus_speed_cyclone_end bus_speed/cyclone_end.c)
  target_link_libraries(bus_speed_cyclone_end PRIVATE bus_speed dyncal_idlc CycloneDDS::ddsc)
endif()
if(DYNCAL_FAST_DDS)
  add_executable(bus_speed_fast_end bus_speed/fast_end.cpp)
  target_link_libraries(bus_speed_fast_end PRIVATE bus_speed native_fast_types)
endif()
if(DYNCAL_CYCLONE_DDS AND DYNCAL_FAST_DDS)
  add_test(NAME bus_speed.every_block_arrives
    COMMAND /usr/bin/python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/bus_speed/bus_speed.py
      ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} --rounds 1 --seconds 0.3)
  set_tests_properties(bus_speed.every_block_arrives
    PROPERTIES LABELS benchmark TIMEOUT 300 RUN_SERIAL ON)
endif()
