// The language server for texts of robots, and their graph and picture beside the text, drawn anew whenever it is saved.
"use strict";

const { execFile } = require("node:child_process");
const { mkdtemp, readFile, rm } = require("node:fs/promises");
const { tmpdir } = require("node:os");
const { join } = require("node:path");
const vscode = require("vscode");
const { LanguageClient, TransportKind } = require("vscode-languageclient/node");

const SELECTOR = [{ scheme: "file", language: "hymeko" }, { scheme: "file", pattern: "**/*.{urdf,xacro,mjcf,sdf}" }];
const VIEWS = {
  graph: { verb: "graph", suffix: ".svg", type: "image/svg+xml", title: "Graph of" },
  picture: { verb: "render", suffix: ".png", type: "image/png", title: "Picture of" },
};

let client;
const panels = new Map(); // by view and file

function command() {
  return vscode.workspace.getConfiguration("hymeko-x").get("command");
}

async function start() {
  const server = { command: command(), args: ["lsp"], transport: TransportKind.stdio };
  client = new LanguageClient("hymeko-x", "HyMeKo", server, { documentSelector: SELECTOR });
  try {
    await client.start();
  } catch (error) {
    vscode.window.showErrorMessage(`'${command()} lsp' did not start: ${error.message}. pip install 'hymeko-x[lsp]' brings it.`);
  }
}

async function stop() {
  if (client?.isRunning()) await client.stop();
}

/** The bytes that a verb of the program writes for a file. Rejects with the program's own message. */
async function drawn(view, path) {
  const folder = await mkdtemp(join(tmpdir(), "hymeko-x-"));
  const output = join(folder, `out${view.suffix}`);
  try {
    await new Promise((resolve, reject) =>
      execFile(command(), [view.verb, path, "-o", output], (error, _, errors) => (error ? reject(new Error(errors || error.message)) : resolve())),
    );
    return await readFile(output);
  } finally {
    await rm(folder, { recursive: true });
  }
}

function escaped(text) {
  return text.replace(/[&<>]/g, (sign) => `&#${sign.charCodeAt(0)};`);
}

/** Draw a panel anew; where the text cannot be drawn, the message stands above the last picture. */
async function refresh(panel, view, path) {
  let message = "";
  try {
    panel.image = `<img style="max-width: 100%" src="data:${view.type};base64,${(await drawn(view, path)).toString("base64")}">`;
  } catch (error) {
    message = `<pre>${escaped(error.message)}</pre>`;
  }
  const policy = `<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">`;
  panel.webview.html = `<!DOCTYPE html><html><head>${policy}</head><body>${message}${panel.image ?? ""}</body></html>`;
}

async function show(name) {
  const document = vscode.window.activeTextEditor?.document;
  if (!document) return;
  const view = VIEWS[name];
  const key = `${name} ${document.fileName}`;
  if (!panels.has(key)) {
    const title = `${view.title} ${document.fileName.split(/[\\/]/).pop()}`;
    const panel = vscode.window.createWebviewPanel("hymeko-x", title, { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true });
    panel.onDidDispose(() => panels.delete(key));
    panels.set(key, panel);
  }
  panels.get(key).reveal(undefined, true);
  await refresh(panels.get(key), view, document.fileName);
}

async function saved() {
  for (const [key, panel] of panels) {
    const [name, path] = [key.split(" ", 1)[0], key.slice(key.indexOf(" ") + 1)];
    await refresh(panel, VIEWS[name], path); // a file that it imports may be the one that was saved
  }
}

exports.activate = async function (context) {
  const register = (name, action) => context.subscriptions.push(vscode.commands.registerCommand(`hymeko-x.${name}`, action));
  register("graph", () => show("graph"));
  register("picture", () => show("picture"));
  register("restart", async () => {
    await stop();
    await start();
  });
  context.subscriptions.push(vscode.workspace.onDidSaveTextDocument(saved));
  await start();
};

exports.deactivate = stop;
