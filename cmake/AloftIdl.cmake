# aloft_add_idl(TARGET file.idl ...): a static library with the C++ types that fastddsgen makes from IDL files at build
# time. Without -typeobject: type information on the wire would make other DDS implementations refuse the types.
find_package(fastcdr REQUIRED)
find_package(fastrtps REQUIRED)
find_program(FASTDDSGEN fastddsgen REQUIRED)

function(aloft_add_idl target)
  set(output_dir "${CMAKE_CURRENT_BINARY_DIR}/generated/idl")
  file(MAKE_DIRECTORY "${output_dir}")
  set(sources)
  foreach(file ${ARGN})
    get_filename_component(name "${file}" NAME_WE)
    set(generated "${output_dir}/${name}.cxx" "${output_dir}/${name}.h" "${output_dir}/${name}PubSubTypes.cxx"
        "${output_dir}/${name}PubSubTypes.h")
    add_custom_command(
      OUTPUT ${generated}
      COMMAND "${FASTDDSGEN}" -cs -replace -I "${CMAKE_CURRENT_SOURCE_DIR}" -d "${output_dir}"
              "${CMAKE_CURRENT_SOURCE_DIR}/${file}" > "${output_dir}/${name}.log"
      DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/${file}"
      COMMENT "Generating C++ types from ${file}"
      VERBATIM)
    list(APPEND sources ${generated})
  endforeach()
  add_library(${target} STATIC ${sources})
  target_compile_options(${target} PRIVATE -w)
  target_include_directories(${target} SYSTEM PUBLIC "${CMAKE_CURRENT_BINARY_DIR}/generated")
  target_link_libraries(${target} PUBLIC fastrtps fastcdr)
endfunction()
