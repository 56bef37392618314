#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the files of this folder anew from the archives of the npm registry (needs npm and network):
# uPlot as it comes; of three.js, which comes as modules only, what three_parts.js names, as one minified script,
# because a page on a disk cannot load modules.
set -euo pipefail
three=0.187.0 uplot=1.6.32 esbuild=0.28.2

here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm init -y >/dev/null
npm install --silent "three@$three" "uplot@$uplot" "esbuild@$esbuild"
cp "$here/three_parts.js" .
node_modules/.bin/esbuild three_parts.js --bundle --minify --format=iife --global-name=THREE --target=es2020 \
  --legal-comments=inline --banner:js="/* three.js $three, MIT license, bundled by esbuild */" \
  --outfile="$here/three.min.js" --log-level=warning
cp node_modules/three/LICENSE "$here/three.LICENSE"
cp node_modules/uplot/dist/uPlot.iife.min.js "$here/uPlot.min.js"
cp node_modules/uplot/dist/uPlot.min.css node_modules/uplot/LICENSE "$here/"
mv "$here/LICENSE" "$here/uPlot.LICENSE"
