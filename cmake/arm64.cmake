# Cross compilation for ARM64 on Debian, whose packages for it are installed beside those of this processor, or unpacked
# in the folder that the environment variable CSRBF_SYSROOT names. Tests run by qemu-user.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
find_program(qemu NAMES qemu-aarch64 qemu-aarch64-static)
if(DEFINED ENV{CSRBF_SYSROOT})
  set(CMAKE_FIND_ROOT_PATH $ENV{CSRBF_SYSROOT} $ENV{CSRBF_SYSROOT}/usr /usr/aarch64-linux-gnu)
  set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,-rpath-link,$ENV{CSRBF_SYSROOT}/usr/lib/aarch64-linux-gnu:$ENV{CSRBF_SYSROOT}/lib/aarch64-linux-gnu")
  set(CMAKE_CROSSCOMPILING_EMULATOR ${qemu} -L /usr/aarch64-linux-gnu -E
                                    LD_LIBRARY_PATH=$ENV{CSRBF_SYSROOT}/usr/lib/aarch64-linux-gnu:$ENV{CSRBF_SYSROOT}/lib/aarch64-linux-gnu)
else()
  set(CMAKE_CROSSCOMPILING_EMULATOR ${qemu} -L /usr/aarch64-linux-gnu)
endif()
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
