#!/usr/bin/env bash
# Checks the rules for alerts with promtool: that they parse, that each fires and
# resolves (deploy/prometheus/tactus.rules_test.yml), that the page on monitoring
# has a section on each, and that the dashboard's expressions parse.
#
#   tests/server/metrics/rules_check.sh
#
# Prints "skipped" without promtool.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../../.."
readonly folder=deploy/prometheus

if ! command -v promtool >/dev/null; then
  echo "rules_check: skipped, needs promtool"
  exit 0
fi
promtool check rules "$folder/tactus.rules.yml"
promtool check config "$folder/prometheus.yml"
promtool test rules "$folder/tactus.rules_test.yml"

alerts=$(sed -n 's/^ *- alert: *//p' "$folder/tactus.rules.yml")
for alert in $alerts; do
  if ! grep -qx "### $alert" docs/monitoring.md; then
    echo "rules_check: docs/monitoring.md has no section $alert" >&2
    exit 1
  fi
  # Once where it fires, once where it does not.
  if [[ $(grep -c "alertname: *$alert\$" "$folder/tactus.rules_test.yml") -lt 2 ]]; then
    echo "rules_check: $alert needs a test in which it fires, and one in which not" >&2
    exit 1
  fi
done

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
/usr/bin/python3 -B - "$folder/tactus-dashboard.json" >"$work/dashboard.yml" <<'PYTHON'
import json
import re
import sys


def expressions(node):
    if isinstance(node, dict):
        if isinstance(node.get("expr"), str):
            yield node["expr"]
        for child in node.values():
            yield from expressions(child)
    elif isinstance(node, list):
        for child in node:
            yield from expressions(child)


with open(sys.argv[1], encoding="utf-8") as file:
    dashboard = json.load(file)
print("groups:\n  - name: dashboard\n    rules:")
for number, text in enumerate(expressions(dashboard)):
    # Grafana's variables stand for times and names.
    text = text.replace("$__rate_interval", "5m").replace("$__range", "1h")
    text = re.sub(r"\$\{?\w+\}?", ".*", text)
    print(f"      - record: dashboard:expression{number}\n        expr: {json.dumps(text)}")
PYTHON
promtool check rules "$work/dashboard.yml"
echo "rules_check: $(wc -w <<<"$alerts") alerts, all tested"
