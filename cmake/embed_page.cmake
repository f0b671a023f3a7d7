# Writes a source file with what every HTML report embeds: style sheet, script (when there is one) and licences.
# The same for the studio's page, which is one file with all of it.
# usage: cmake -D SOURCE_DIR=... -D OUTPUT=... [-D SCRIPT=... -D PLOTS=... -D STUDIO=...] -P embed_page.cmake
cmake_minimum_required(VERSION 3.25)

# Sets `variable` to a C++ literal of the file; no sensible file contains the delimiter.
function(read_literal file variable)
  file(READ ${file} text)
  set(${variable} "R\"csrbf_page(${text})csrbf_page\"" PARENT_SCOPE)
endfunction()

file(READ ${SOURCE_DIR}/viewer/viewer.css viewer_style)
file(READ ${SOURCE_DIR}/viewer/report.css report_style)
set(style "R\"csrbf_page(${viewer_style}${report_style})csrbf_page\"")
set(script "\"\"")
set(plots "\"\"")
if(PLOTS)
  read_literal(${PLOTS} plots)
endif()
set(licence "This page and the program that made it:\n\n")
if(SCRIPT)
  read_literal(${SCRIPT} script)
  # Both have the same licence, whose terms must accompany the code.
  string(CONCAT licence "The interactive view contains three.js, Copyright (c) 2010 and later, three.js authors, under "
                        "the MIT License, whose terms are those below. ${licence}")
endif()
file(READ ${SOURCE_DIR}/LICENSE terms)
set(studio "\"\"")
if(STUDIO)
  read_literal(${STUDIO} studio)
endif()

file(WRITE ${OUTPUT} "#include \"report/page_files.hpp\"

namespace csrbf::app {

const std::string_view page_style = ${style};

const std::string_view page_script = ${script};

const std::string_view page_plots_script = ${plots};

const std::string_view studio_page = ${studio};

const std::string_view page_licence = R\"csrbf_page(${licence}${terms})csrbf_page\";

}  // namespace csrbf::app
")
