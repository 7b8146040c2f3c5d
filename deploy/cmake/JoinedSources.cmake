# Sources of a library or program are compiled eight as one: headers that they share are read once,
# which saves about a third of a build's processor time from nothing. After a change it compiles
# eight sources for one, so that it is for those who use dyncal (preset "programs"), not for those
# who change it.
#
# What a source declares in unnamed namespaces is seen by those that are joined behind it. It could
# be taken there in place of another thing of that name, without a word of the compiler: so a source
# is joined to others only where it does not mention any name that they declare so. Nobody has to
# know of it who writes sources; Style.Joined holds it.
include_guard(DIRECTORY)

set(dyncal_joined_sources 8) # 12 and 16 leave nearly as many units, most targets being small

# What a source declares in unnamed namespaces: clang-format begins each declaration at column 0.
function(dyncal_unnamed_names text result)
  set(names "")
  string(FIND "${text}" "\nnamespace {\n" begin)
  while(begin GREATER -1)
    string(SUBSTRING "${text}" ${begin} -1 text)
    string(FIND "${text}" "\n} // namespace\n" end)
    if(end EQUAL -1) # of one line, or its end is not to be seen
      message(FATAL_ERROR "a source has an unnamed namespace that does not end with\n"
        "} // namespace\n${text}")
    endif()
    string(SUBSTRING "${text}" 0 ${end} unnamed)
    string(SUBSTRING "${text}" ${end} -1 text)
    string(REGEX MATCHALL "\n[A-Za-z][^][\n;(){}=]*" declarations "${unnamed}")
    foreach(declaration IN LISTS declarations)
      if(NOT declaration MATCHES "^\n(namespace|using namespace|using [A-Za-z_:]+::)"
         AND declaration MATCHES "[^A-Za-z0-9_]([A-Za-z0-9_]+) *$")
        list(APPEND names ${CMAKE_MATCH_1})
      endif()
    endforeach()
    string(FIND "${text}" "\nnamespace {\n" begin)
  endwhile()
  list(REMOVE_DUPLICATES names) # overloads
  set(${result} ${names} PARENT_SCOPE)
endfunction()

# Every word of it but for comments, members and what is named with its namespace.
function(dyncal_mentioned_names text result)
  string(REGEX REPLACE "//[^\n]*|(\\.|->|::)[A-Za-z_][A-Za-z0-9_]*" "" text "${text}")
  string(REGEX MATCHALL "[A-Za-z_][A-Za-z0-9_]*" mentioned "${text}")
  list(REMOVE_DUPLICATES mentioned)
  set(${result} ${mentioned} PARENT_SCOPE)
endfunction()

# A unit: the headers of its sources, which so see nothing of what sources declare, then these.
function(dyncal_add_joined target name sources)
  get_target_property(folder ${target} SOURCE_DIR)
  set(headers "")
  set(joined "")
  foreach(source IN LISTS sources)
    file(READ ${folder}/${source} text)
    string(REGEX REPLACE "\n#if.*" "" text "${text}") # for libraries that may not be there
    string(REGEX MATCHALL "#include \"[^\"\n]+\"" included "${text}")
    list(APPEND headers ${included})
    string(APPEND joined "#include \"${folder}/${source}\"\n")
    set_source_files_properties(${folder}/${source} TARGET_DIRECTORY ${target}
      PROPERTIES HEADER_FILE_ONLY ON)
  endforeach()
  list(REMOVE_DUPLICATES headers)
  list(JOIN headers "\n" headers)
  get_target_property(binary_folder ${target} BINARY_DIR)
  set(unit ${binary_folder}/joined/${name}.cpp)
  file(CONFIGURE OUTPUT ${unit} CONTENT "${headers}\n\n${joined}" @ONLY)
  target_sources(${target} PRIVATE ${unit})
endfunction()

# The first group that has room takes a source, if the source mentions nothing that is declared in
# it. A source with options or definitions of its own stays alone.
function(dyncal_join_sources target)
  get_target_property(folder ${target} SOURCE_DIR)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "^[^/$][^$]*\\.cpp$") # none that is generated
  set(groups 0)
  foreach(source IN LISTS sources)
    get_source_file_property(options ${folder}/${source} TARGET_DIRECTORY ${target} COMPILE_OPTIONS)
    get_source_file_property(definitions ${folder}/${source}
      TARGET_DIRECTORY ${target} COMPILE_DEFINITIONS)
    if(options OR definitions)
      continue()
    endif()
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${folder}/${source})
    file(READ ${folder}/${source} text)
    dyncal_unnamed_names("${text}" unnamed)
    dyncal_mentioned_names("${text}" mentioned)
    set(group 0)
    while(group LESS groups)
      set(apart ${names_${group}})
      list(REMOVE_ITEM apart ${mentioned})
      list(LENGTH sources_${group} size)
      if(size LESS dyncal_joined_sources AND "${apart}" STREQUAL "${names_${group}}")
        break()
      endif()
      math(EXPR group "${group} + 1")
    endwhile()
    if(group EQUAL groups)
      math(EXPR groups "${groups} + 1")
      set(sources_${group} "")
      set(names_${group} "")
    endif()
    list(APPEND sources_${group} ${source})
    list(APPEND names_${group} ${unnamed})
  endforeach()
  if(groups EQUAL 0)
    return()
  endif()
  math(EXPR last "${groups} - 1")
  foreach(group RANGE ${last})
    dyncal_add_joined(${target} ${target}_${group} "${sources_${group}}")
  endforeach()
endfunction()

# After all targets of the tree have been added.
function(dyncal_join_all_sources)
  foreach(tree analysis drivers services)
    dyncal_targets_below(${CMAKE_CURRENT_SOURCE_DIR}/${tree} targets)
    foreach(target IN LISTS targets)
      get_target_property(libraries ${target} LINK_LIBRARIES)
      get_target_property(sources ${target} SOURCES)
      if(libraries MATCHES "dyncal_options" AND sources MATCHES "\\.cpp")
        dyncal_join_sources(${target})
      endif()
    endforeach()
  endforeach()
endfunction()
