dyncal_benchmark(sine_benchmark SOURCES sine_benchmark.cpp LIBRARIES dyncal_analysis)
target_compile_options(sine_benchmark PRIVATE -O3)
