# aloft_add_idl(TARGET file.idl ...): a static library with the C++ types that fastddsgen makes from IDL files at build
# time, without type information: on the wire it would make other DDS implementations refuse the types. Include them as
# <idl/types.hpp> and their type supports as <idl/type_supports.hpp>, whatever the generator calls its files.
find_package(fastcdr REQUIRED)
find_program(FASTDDSGEN fastddsgen REQUIRED)

function(aloft_add_idl target)
  set(output_dir "${CMAKE_CURRENT_BINARY_DIR}/generated/idl")
  # Its temporary files have the names of the IDL files: in /tmp, builds of two checkouts would disturb each other.
  set(temporary_dir "${CMAKE_CURRENT_BINARY_DIR}/generated/temporary")
  file(MAKE_DIRECTORY "${output_dir}" "${temporary_dir}")
  if(ALOFT_MIDDLEWARE STREQUAL "fastdds")
    set(endings .hpp CdrAux.hpp CdrAux.ipp PubSubTypes.hpp PubSubTypes.cxx)
    set(header_ending .hpp)
    set(options -no-typeobjectsupport -flat-output-dir)
  else()
    set(endings .h .cxx PubSubTypes.h PubSubTypes.cxx)
    set(header_ending .h)
    set(options "")
  endif()
  set(sources)
  set(types "")
  set(type_supports "")
  foreach(file ${ARGN})
    get_filename_component(name "${file}" NAME_WE)
    foreach(ending ${endings})
      list(APPEND sources "${output_dir}/${name}${ending}")
    endforeach()
    string(APPEND types "#include \"${name}${header_ending}\"\n")
    string(APPEND type_supports "#include \"${name}PubSubTypes${header_ending}\"\n")
  endforeach()
  file(CONFIGURE OUTPUT "${output_dir}/types.hpp" CONTENT "#pragma once\n${types}" @ONLY)
  file(CONFIGURE OUTPUT "${output_dir}/type_supports.hpp" CONTENT "#pragma once\n${type_supports}" @ONLY)
  # One call for all files: each call also writes the types of the files that its own ones include.
  list(TRANSFORM ARGN PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/" OUTPUT_VARIABLE files)
  add_custom_command(
    OUTPUT ${sources}
    COMMAND "${FASTDDSGEN}" -cs -replace ${options} -I "${CMAKE_CURRENT_SOURCE_DIR}" -d "${output_dir}"
            -t "${temporary_dir}" ${files} > "${output_dir}/fastddsgen.log"
    DEPENDS ${files}
    COMMENT "Generating C++ types from IDL"
    VERBATIM)
  add_library(${target} STATIC ${sources})
  target_compile_options(${target} PRIVATE -w)
  target_include_directories(${target} SYSTEM PUBLIC "${CMAKE_CURRENT_BINARY_DIR}/generated")
  target_link_libraries(${target} PUBLIC ${ALOFT_MIDDLEWARE} fastcdr)
endfunction()
