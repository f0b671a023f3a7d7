# Writes the studio's page: viewer/studio.html with style sheets and script in it.
# usage: cmake -D SOURCE_DIR=... -D SCRIPT=... -D OUTPUT=... [-D VIEWER=...] -P studio_page.cmake; VIEWER: a script beside
# the page, loaded first
cmake_minimum_required(VERSION 3.25)

file(READ ${SOURCE_DIR}/viewer/studio.html page)
file(READ ${SOURCE_DIR}/viewer/viewer.css viewer_style)
file(READ ${SOURCE_DIR}/viewer/studio.css studio_style)
file(READ ${SCRIPT} script)
if(VIEWER)
  string(REPLACE "<script>\n/* script */" "<script src=\"${VIEWER}\"></script>\n<script>\n/* script */" page "${page}")
endif()
string(REPLACE "/* style */" "${viewer_style}${studio_style}" page "${page}")
string(REPLACE "/* script */" "${script}" page "${page}")
file(WRITE ${OUTPUT} "${page}")
