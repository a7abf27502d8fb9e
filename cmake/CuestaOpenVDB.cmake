# OpenVDB::openvdb, found by the module that OpenVDB installs. That folder has modules for others too (TBB, ZLIB's
# users, …), so it is on the path for this one call only. The module reports each component as a notice.
function(cuesta_find_openvdb)
  list(PREPEND CMAKE_MODULE_PATH /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB)
  set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
  find_package(OpenVDB 10.0 REQUIRED COMPONENTS openvdb)
  # In a function: the module's variables end here, the imported targets hold for the folder and below.
endfunction()
cuesta_find_openvdb()

# Sources that include OpenVDB: its types register themselves in statics of templates, of which the program and
# the library must see one copy. With hidden ones openvdb::initialize() crashes.
# No sanitizers: with them g++ 12 takes minutes and more than 2 GiB for each, instead of 15 s and 0.9 GiB.
function(cuesta_uses_openvdb)
  set_source_files_properties(${ARGN} PROPERTIES
    COMPILE_OPTIONS "-fvisibility=default;-fno-visibility-inlines-hidden;-fno-sanitize=all")
endfunction()
