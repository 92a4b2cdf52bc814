# Warnings, contraction and sanitizers for our own targets.
function(radivox_target name)
  target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/radivox>)
  target_compile_options(${name} PRIVATE -Wall -Wextra -Wshadow -Wconversion -Wno-missing-field-initializers
    # GCC 12 sees overlaps in "literal" + std::string where there are none (GCC bug 105651).
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
    # Float results must not depend on what the compiler fuses: CPU oracles are compared with shaders bit for bit.
    -ffp-contract=off)
  if(RADIVOX_SANITIZE)
    target_compile_options(${name} PUBLIC -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
    target_link_options(${name} PUBLIC -fsanitize=address,undefined)
  endif()
endfunction()

# For targets whose own code takes no time worth naming: optimizing it would take half of the time to build it.
function(radivox_compile_fast name)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-Og>)
endfunction()
