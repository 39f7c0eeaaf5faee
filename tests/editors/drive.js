// The extension in a stand-in for VS Code: it is activated, a view of a file is opened, and the file is saved with an error. Prints what it did as JSON.
"use strict";

const Module = require("node:module");
const [extension, program, file, view] = process.argv.slice(2);
const commands = {};
const panels = [];
const errors = [];
let onSave;
let server;

const vscode = {
  ViewColumn: { Beside: -2 },
  commands: { registerCommand: (name, action) => (commands[name] = action) },
  window: {
    activeTextEditor: { document: { fileName: file } },
    createWebviewPanel: (_, title) => {
      panels.push({ title, webview: { html: "" }, onDidDispose() {}, reveal() {} });
      return panels.at(-1);
    },
    showErrorMessage: (message) => errors.push(message),
  },
  workspace: { getConfiguration: () => ({ get: () => program }), onDidSaveTextDocument: (action) => (onSave = action) },
};
class LanguageClient {
  constructor(_, __, options) {
    server = options;
  }
  start() {}
}
const fakes = { vscode, "vscode-languageclient/node": { LanguageClient, TransportKind: { stdio: 0 } } };
const load = Module._load;
Module._load = (name, ...rest) => fakes[name] ?? load(name, ...rest);

async function main() {
  await require(extension).activate({ subscriptions: [] });
  await commands[`hymeko-x.${view}`]();
  const first = panels[0].webview.html;
  require("node:fs").writeFileSync(file, "arm : robot {");
  await onSave();
  const second = panels[0].webview.html;
  process.stdout.write(JSON.stringify({ commands: Object.keys(commands), server, title: panels[0].title, first, second, errors }));
}

main();
