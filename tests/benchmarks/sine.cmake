dyncal_benchmark(sine_benchmark SOURCES sine_benchmark.cpp LIBRARIES dyncal_analysis)
target_compile_options(sine_benchmark PRIVATE -O3)

# C++, numpy and scipy on the same data in one process:
# sine_against_python.py BUILD/lib/libsine_shared.so
add_library(sine_shared SHARED sine_shared.cpp)
target_link_libraries(sine_shared PRIVATE dyncal_options dyncal_analysis)
target_compile_options(sine_shared PRIVATE -O3) # for what only reads, too
set_target_properties(sine_shared PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
