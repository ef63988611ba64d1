#!/bin/sh
# Fetches the report's libraries from npm and renews the check sums: Observable Plot on D3 (both ISC) as they are published, and
# of three.js (MIT) the parts that three_entry.js names, bundled by esbuild.
#   reports/vendor/refresh.sh [PLOT_VERSION] [D3_VERSION] [THREE_VERSION] [ESBUILD_VERSION]
# Only for maintainers: building and reading reports never needs npm or a network.
set -eu
plot_version=${1:-0.6.17}
d3_version=${2:-7.9.2}
three_version=${3:-0.170.0}
esbuild_version=${4:-0.28.2}
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm pack --silent "@observablehq/plot@$plot_version" "d3@$d3_version" >/dev/null
mkdir plot d3
tar xzf observablehq-plot-*.tgz -C plot
tar xzf d3-*.tgz -C d3
cp plot/package/dist/plot.umd.min.js "$here/plot.umd.min.js"
cp plot/package/LICENSE "$here/plot.LICENSE"
cp d3/package/dist/d3.min.js "$here/d3.min.js"
cp d3/package/LICENSE "$here/d3.LICENSE"
npm install --silent --no-audit --no-fund "three@$three_version" "esbuild@$esbuild_version" >/dev/null
cp "$here/three_entry.js" .
node_modules/.bin/esbuild three_entry.js --bundle --minify --format=iife --global-name=THREE --legal-comments=none --log-level=warning --outfile="$here/three.min.js"
cp node_modules/three/LICENSE "$here/three.LICENSE"
cd "$here"
sha256sum d3.min.js d3.LICENSE plot.umd.min.js plot.LICENSE three.min.js three.LICENSE >SHA256SUMS
cat SHA256SUMS
