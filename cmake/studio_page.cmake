# Writes the studio's page: viewer/studio.html with style sheets and script in it.
# usage: cmake -D SOURCE_DIR=... -D SCRIPT=... -D OUTPUT=... -P studio_page.cmake
cmake_minimum_required(VERSION 3.25)

file(READ ${SOURCE_DIR}/viewer/studio.html page)
file(READ ${SOURCE_DIR}/viewer/viewer.css viewer_style)
file(READ ${SOURCE_DIR}/viewer/studio.css studio_style)
file(READ ${SCRIPT} script)
string(REPLACE "/* style */" "${viewer_style}${studio_style}" page "${page}")
string(REPLACE "/* script */" "${script}" page "${page}")
file(WRITE ${OUTPUT} "${page}")
