# Run by CPack on the files to be packaged: adds what Debian requires, in its own form.
set(share ${CPACK_TEMPORARY_INSTALL_DIRECTORY}${CPACK_PACKAGING_INSTALL_PREFIX}/share)
set(doc ${share}/doc/csrbf)

function(compress)
  execute_process(COMMAND gzip -9nf ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(RENAME ${doc}/LICENSE ${doc}/copyright)
# Where zsh of Debian looks.
file(RENAME ${share}/zsh/site-functions ${share}/zsh/vendor-completions)
file(WRITE ${doc}/changelog
     "csrbf (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium\n\n  * Packaged from the release's own build.\n\n"
     " -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER}  ${CPACK_CSRBF_DATE}\n")
file(GLOB pages ${share}/man/man1/*.1)
compress(${doc}/changelog ${pages})

# A single package, for users to install with one command; Debian itself would split it into four. The scripts that
# call ldconfig are CPack's own.
set(overrides package-name-doesnt-match-sonames link-to-shared-library-in-wrong-package "maintscript-calls-ldconfig *")
list(TRANSFORM overrides PREPEND "csrbf: ")
list(JOIN overrides "\n" overrides)
file(WRITE ${share}/lintian/overrides/csrbf "${overrides}\n")
