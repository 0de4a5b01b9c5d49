// The side of `lagc lsp` in VS Code: it starts the server, and shows equations and explanations beside a text.

const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

const SCHEME = "lag";
const texts = new Map(); // that are shown beside, by path
const changed = new vscode.EventEmitter();
let client;

async function start() {
  const command = vscode.workspace.getConfiguration("lag").get("path");
  client = new LanguageClient("lag", { command, args: ["lsp"] }, { documentSelector: [{ language: "lag" }] });
  try {
    await client.start();
  } catch (error) {
    client = undefined;
    const install = 'pip install "lagc[lsp]"';
    vscode.window.showWarningMessage(`\`${command} lsp\` does not start (${error.message}): ${install}`);
  }
}

async function restart() {
  await client?.stop();
  await start();
}

function ask(command, ...given) {
  return client?.sendRequest("workspace/executeCommand", { command, arguments: given });
}

async function show(path, text) {
  const uri = vscode.Uri.from({ scheme: SCHEME, path });
  texts.set(path, text);
  changed.fire(uri);
  await vscode.window.showTextDocument(uri, { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true });
}

async function equations() {
  const document = vscode.window.activeTextEditor?.document;
  const found = document && (await ask("lagc.equations", document.uri.toString()));
  if (!found) return;
  const faults = (found.faults ?? []).map((fault) => `${fault.code}: ${fault.message}`);
  await show(`${document.uri.path}.equations`, found.equations ?? faults.join("\n"));
}

async function explain() {
  const editor = vscode.window.activeTextEditor;
  const faults = editor ? vscode.languages.getDiagnostics(editor.document.uri) : [];
  const fault = faults.find((each) => each.source === "lagc" && each.range.intersection(editor.selection));
  if (fault) await show(`/${fault.code}`, (await ask("lagc.explain", fault.code)) ?? "");
}

exports.activate = async (context) => {
  const provider = { onDidChange: changed.event, provideTextDocumentContent: (uri) => texts.get(uri.path) ?? "" };
  context.subscriptions.push(
    vscode.workspace.registerTextDocumentContentProvider(SCHEME, provider),
    vscode.commands.registerCommand("lag.equations", equations),
    vscode.commands.registerCommand("lag.explain", explain),
    vscode.commands.registerCommand("lag.restart", restart),
  );
  await start();
};

exports.deactivate = () => client?.stop();
