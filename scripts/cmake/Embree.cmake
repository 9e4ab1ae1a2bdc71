# palpate_use_embree(TARGET): links a target with Embree 4, or with 3, which Debian 12 has; PALPATE_EMBREE is which.
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  find_package(embree 3 REQUIRED)
endif()

function(palpate_use_embree target)
  target_link_libraries(${target} PRIVATE embree)
  target_compile_definitions(${target} PRIVATE PALPATE_EMBREE=${embree_VERSION_MAJOR})
endfunction()
