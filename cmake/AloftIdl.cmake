# aloft_add_idl(TARGET file.idl ...): a static library with the C++ types that fastddsgen makes from IDL files at build
# time. Without -typeobject: type information on the wire would make other DDS implementations refuse the types.
find_package(fastcdr REQUIRED)
find_package(fastrtps REQUIRED)
find_program(FASTDDSGEN fastddsgen REQUIRED)

function(aloft_add_idl target)
  set(output_dir "${CMAKE_CURRENT_BINARY_DIR}/generated/idl")
  # Its temporary files have the names of the IDL files: in /tmp, builds of two checkouts would disturb each other.
  set(temporary_dir "${CMAKE_CURRENT_BINARY_DIR}/generated/temporary")
  file(MAKE_DIRECTORY "${output_dir}" "${temporary_dir}")
  set(sources)
  foreach(file ${ARGN})
    get_filename_component(name "${file}" NAME_WE)
    list(APPEND sources "${output_dir}/${name}.cxx" "${output_dir}/${name}.h" "${output_dir}/${name}PubSubTypes.cxx"
         "${output_dir}/${name}PubSubTypes.h")
  endforeach()
  # One call for all files: each call also writes the types of the files that its own ones include.
  list(TRANSFORM ARGN PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/" OUTPUT_VARIABLE files)
  add_custom_command(
    OUTPUT ${sources}
    COMMAND "${FASTDDSGEN}" -cs -replace -I "${CMAKE_CURRENT_SOURCE_DIR}" -d "${output_dir}" -t "${temporary_dir}" ${files}
            > "${output_dir}/fastddsgen.log"
    DEPENDS ${files}
    COMMENT "Generating C++ types from IDL"
    VERBATIM)
  add_library(${target} STATIC ${sources})
  target_compile_options(${target} PRIVATE -w)
  target_include_directories(${target} SYSTEM PUBLIC "${CMAKE_CURRENT_BINARY_DIR}/generated")
  target_link_libraries(${target} PUBLIC fastrtps fastcdr)
endfunction()
