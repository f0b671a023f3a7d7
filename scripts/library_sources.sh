# Sourced by windows_libraries and wasm_libraries, in the folder to work in: gets Debian's sources and packages.

# The archives of this machine's distribution, with their sources, in lists of this script's own; without security
# updates, of which mirrors may not have the sources.
prepare_archives() {
  local work=$PWD file sources=sources.list sandbox=()
  [[ $(id -u) -ne 0 ]] || sandbox=(-o APT::Sandbox::User=root)
  mkdir -p lists/partial
  shopt -s nullglob
  sed -n '/security/d; s/^deb /deb-src /p' /etc/apt/sources.list.d/*.list $([[ -e /etc/apt/sources.list ]] && echo /etc/apt/sources.list) \
    /dev/null >sources.list
  for file in /etc/apt/sources.list.d/*.sources; do
    awk -v RS= -v ORS='\n\n' '!/security/ { sub(/Types:[^\n]*/, "Types: deb-src"); print }' "$file"
  done >deb822.sources
  [[ -s $sources ]] || sources=deb822.sources
  packages=(apt-get -qq "${sandbox[@]}")
  archives=("${packages[@]}" -o Dir::Etc::SourceList="$work/$sources" -o Dir::Etc::SourceParts=- -o Dir::State::Lists="$work/lists")
  "${archives[@]}" update
}

# get_sources PACKAGE...: unpacks their sources here.
get_sources() {
  "${archives[@]}" source "$@" >/dev/null
}

# unpack_packages FOLDER PACKAGE...: unpacks binary packages there, without installing them.
unpack_packages() {
  local package
  "${packages[@]}" download "${@:2}"
  for package in *.deb; do dpkg-deb -x "$package" "$1"; done
}

# compile_libraries_with TOOLCHAIN FOLDER, then compile SOURCE CMAKE-OPTION...: by that toolchain into the folder.
compile_libraries_with() {
  toolchain=$1
  prefix=$2
}
# The log is beside the source.
compile() {
  cmake -S "$1" -B "$1/build" -G Ninja -DCMAKE_TOOLCHAIN_FILE="$toolchain" -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_INSTALL_PREFIX="$prefix" -DBUILD_SHARED_LIBS=OFF "${@:2}" >"${1%/}.log"
  cmake --build "$1/build" >>"${1%/}.log"
  cmake --install "$1/build" >>"${1%/}.log"
}
# Of TIFF's codecs zlib only.
tiff_options=(-Dtiff-tools=OFF -Dtiff-tests=OFF -Dtiff-docs=OFF -Dtiff-contrib=OFF -Djpeg=OFF -Dlzma=OFF -Dzstd=OFF
  -Dwebp=OFF -Dlibdeflate=OFF -Djbig=OFF -Dlerc=OFF -Dcxx=OFF)
