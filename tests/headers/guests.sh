#!/usr/bin/env bash
# What is built on the library can be dropped: without the folders of its guests and the lines that name them the rest
# configures, finds all that it includes, and what had named them compiles. guests.sh COMPILER ROOT.
set -euo pipefail
compiler=$1
cd "$2"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# Guests are viewer, python, mpi, runtime, web and integrations, which are not copied, and two of the program's rooms.
cp -r CMakeLists.txt cmake packages files mesh cubemap lights prt relight relumine data_gen app pyproject.toml "$work"
cd "$work"
rm -r app/movies app/web
sed -i '/^ *\(movies\|web\)\/[a-z_/. ]*$/d' app/CMakeLists.txt
sed -i '/add_animate(\|add_export_web(/d' app/commands.h app/program.cpp
[ "$(cat app/CMakeLists.txt app/commands.h app/program.cpp | grep -cE 'movies/|web/[a-z_]*\.cpp|add_animate|export_web')" = 0 ] ||
    { echo "expected the lines of movies and web to be whole lines" >&2; exit 1; }

failed=0
while IFS=: read -r source header; do
    # The window's command says that there is none.
    [ -f "$header" ] || [ "$source:$header" = app/view.cpp:viewer/view.h ] || { echo "$source includes $header"; failed=1; }
done < <(grep -rHoE '^#include "[^"]+"' --include='*.h' --include='*.cpp' . | sed -E 's|^\./||; s|#include "(.*)"|\1|')
[ "$failed" = 0 ] || { echo "expected a house that stands without its guests" >&2; exit 1; }
cmake -S . -B build -DCMAKE_CXX_COMPILER="$compiler" -DRELUMINE_BUILD_TESTS=OFF -DRELUMINE_INSTALL=OFF >build.log 2>&1 ||
    { tail -n 20 build.log >&2; exit 1; }
"$compiler" -std=c++20 -fsyntax-only -I. app/program.cpp app/scenes/export.cpp
