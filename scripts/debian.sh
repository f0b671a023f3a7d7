# Sourced by check and quickstart: installs Debian or Ubuntu packages that are missing.

# What every build of csrbf needs.
build_packages=(g++ cmake ninja-build libeigen3-dev libnanoflann-dev libpng-dev libtiff-dev zlib1g-dev libqhull-dev
  libcli11-dev nlohmann-json3-dev)

# What makes the surfaces in reports interactive, and the server of the studio.
viewer_packages=(libjs-three esbuild libcpp-httplib-dev)

# What the tests in a browser need in addition.
browser_packages=(chromium chromium-driver python3-selenium)

# What files of maps and pictures need in addition, and the programs and libraries that their tests compare with.
format_packages=(libgdal-dev libjpeg-dev)
format_test_packages=(gdal-bin lib3mf1)

# What the Python module needs in addition.
python_packages=(python3-dev python3-numpy pybind11-dev)

# What its tests compare with or use; tests whose packages are missing are skipped.
python_test_packages=(python3-scipy python3-sklearn python3-tqdm mypy python3-pip python3-venv
  python3-matplotlib python3-yaml python3-pandas python3-xarray python3-nibabel jupyter-nbconvert python3-ipykernel)

# What the tests on several processes need in addition.
distributed_packages=(openmpi-bin python3-distributed)

# What the preset libcxx needs in addition; its GoogleTest is compiled from source.
libcxx_packages=(clang libc++-dev libc++abi-dev googletest libgtest-dev)

# What the preset arm64 needs besides libraries for that processor.
arm64_packages=(crossbuild-essential-arm64 qemu-user googletest libgtest-dev)

# What scripts/windows_libraries and the preset windows need.
windows_packages=(g++-mingw-w64-x86-64-posix wine64 dpkg-dev googletest libgtest-dev)

# What scripts/wasm_libraries and the preset wasm need.
wasm_packages=(emscripten nodejs dpkg-dev xz-utils)

# What the documentation site needs.
docs_packages=(python3-sphinx python3-myst-parser furo doxygen)

# run_as_root COMMAND...: runs it directly as root, else through sudo.
run_as_root() {
  if [[ $(id -u) -eq 0 ]]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    echo "This needs root and sudo is not installed. Run as root: $*" >&2
    return 1
  fi
}

# install_packages PACKAGE...: installs those that are not installed yet; does nothing when none is missing.
install_packages() {
  if ! command -v dpkg-query >/dev/null; then
    echo "No dpkg here: install by hand what corresponds to: $*" >&2
    return 0
  fi
  local package missing=()
  for package in "$@"; do
    [[ $(dpkg-query -W -f '${Status}' "$package" 2>/dev/null) == *' ok installed' ]] || missing+=("$package")
  done
  [[ ${#missing[@]} -eq 0 ]] && return 0
  echo "Installing ${missing[*]}"
  update_package_lists
  run_as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" \
    </dev/null >/dev/null
}

# choose_compiler: unless CXX names one, clang 19 where the system offers it, for it compiles the large files of csrbf
# in two thirds to three quarters of the time of GCC 12 (benchmarks/BUILD.md); else what CMake finds.
choose_compiler() {
  [[ -z ${CXX:-} ]] || return 0
  if ! command -v clang++-19 >/dev/null; then
    [[ -n $(apt-cache show clang-19 2>/dev/null) ]] && install_packages clang-19 || return 0
  fi
  export CXX=clang++-19
}

# install_clang: clang with its sanitizers.
install_clang() {
  install_packages clang
  install_packages "libclang-rt-$(clang -dumpversion | cut -d . -f 1)-dev"
}

# update_package_lists: apt-get update, once per run.
package_lists_are_fresh=no
update_package_lists() {
  [[ $package_lists_are_fresh == yes ]] && return 0
  run_as_root apt-get update -qq </dev/null
  package_lists_are_fresh=yes
}
