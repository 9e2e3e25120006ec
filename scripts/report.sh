#!/bin/sh
# Builds carom and makes the page of figures, claims, trade, stability and extremes from runs:
# scripts/report.sh [options of report.py], into report/report.html.
# Installs what is missing (Debian, Ubuntu; as root or with sudo) and needs nothing but a shell.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd -P)
. "$root/scripts/common.sh"

prepare_program
say 'running the cases'
exec "$python" -B scripts/report.py --carom "$build/carom" "$@"
