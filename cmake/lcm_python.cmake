# SPDX-License-Identifier: MIT
#
# roburoc4_lcm_python(GENERATOR TYPES FOLDER): write the Python package roburoc4_lcm of the LCM types in the
# folder TYPES into FOLDER, with lcm-gen.
function(roburoc4_lcm_python generator types folder)
    file(GLOB files CONFIGURE_DEPENDS ${types}/*.lcm)
    file(REMOVE_RECURSE ${folder}/roburoc4_lcm) # lcm-gen keeps what an __init__.py has
    execute_process(COMMAND ${generator} --python --ppath ${folder} ${files} COMMAND_ERROR_IS_FATAL ANY)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${files})
endfunction()
