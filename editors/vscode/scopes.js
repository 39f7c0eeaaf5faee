// The scopes that VS Code's own tokenizer gives to texts: JSON with their names on standard input, the scopes of each line's tokens on standard output.
"use strict";

const { readFileSync } = require("node:fs");
const { join } = require("node:path");
const oniguruma = require("vscode-oniguruma");
const textmate = require("vscode-textmate");

const SYNTAX = join(__dirname, "syntaxes", "hymeko.tmLanguage.json");

async function main() {
  await oniguruma.loadWASM(readFileSync(require.resolve("vscode-oniguruma/release/onig.wasm")).buffer);
  const onigLib = Promise.resolve({
    createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
    createOnigString: (text) => new oniguruma.OnigString(text),
  });
  const loadGrammar = async () => textmate.parseRawGrammar(readFileSync(SYNTAX, "utf-8"), SYNTAX);
  const grammar = await new textmate.Registry({ onigLib, loadGrammar }).loadGrammar("source.hymeko");
  const found = {};
  for (const [name, text] of Object.entries(JSON.parse(readFileSync(0, "utf-8")))) {
    let stack = textmate.INITIAL;
    found[name] = text.split("\n").map((line) => {
      const { tokens, ruleStack } = grammar.tokenizeLine(line, stack);
      stack = ruleStack;
      return tokens.map(({ startIndex, endIndex, scopes }) => [startIndex, endIndex, scopes]);
    });
  }
  process.stdout.write(JSON.stringify(found));
}

main();
