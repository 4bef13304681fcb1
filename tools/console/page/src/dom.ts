// Making elements. Text goes in as text, never as markup, because names come
// from robots and servers.

export type Child = Node | string;

export function element<K extends keyof HTMLElementTagNameMap>(
    tag: K, attributes: Record<string, string> = {},
    ...children: Child[]): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

// Sets the text if it differs: writing the same text again costs a layout.
export function setText(node: Node, text: string): void {
  if (node.textContent !== text) node.textContent = text;
}

// Sets the attribute if it differs, so that nothing reads it out twice.
export function setAttribute(
    node: Element, name: string, value: string): void {
  if (node.getAttribute(name) !== value) node.setAttribute(name, value);
}

export function byId(id: string): HTMLElement {
  return document.getElementById(id)!;
}
