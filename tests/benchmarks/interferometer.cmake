dyncal_benchmark(interferometer_benchmark
  SOURCES
    interferometer_benchmark.cpp
  LIBRARIES dyncal_analysis)
target_compile_options(interferometer_benchmark PRIVATE -O3)

dyncal_benchmark(interferometer_source_benchmark
  SOURCES
    interferometer_source_benchmark.cpp
  LIBRARIES dyncal_interferometer)
