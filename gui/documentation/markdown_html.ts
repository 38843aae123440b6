// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import GithubSlugger from "github-slugger";
import { parse, Renderer, Tokenizer, type Tokens } from "marked";
import { href } from "../src/route.ts";
import { anchorOf } from "./chapters.ts";

/**
 * The HTML of a document below the title that the page gives it; `file` is where it lies in the project.
 *
 * HTML in the document is text like any other. Of links and pictures that the page does not have, the words stay.
 */
export function markdownHtml(markdown: string, file: string): string {
  return parse(markdown, { async: false, tokenizer: new PlainTokenizer(), renderer: new ChapterRenderer(file) });
}

/** Knows no HTML but comments. */
class PlainTokenizer extends Tokenizer {
  override html(source: string): Tokens.HTML | undefined {
    const [raw] = /^<!--[\s\S]*?-->\s*/.exec(source) ?? [];
    return raw === undefined ? undefined : { type: "html", raw, text: "", block: true, pre: false };
  }

  override tag(): undefined {}
}

class ChapterRenderer extends Renderer {
  private readonly slugger = new GithubSlugger();
  private readonly file: string;

  constructor(file: string) {
    super();
    this.file = file;
  }

  override heading({ depth, text, tokens }: Tokens.Heading): string {
    if (depth === 1) return "";
    const tag = `h${depth + 1}`;
    return `<${tag} id="${this.slugger.slug(text)}">${this.parser.parseInline(tokens)}</${tag}>\n`;
  }

  override code(token: Tokens.Code): string {
    // The keyboard scrolls only what it can reach.
    return super.code(token).replace("<pre>", '<pre tabindex="0">');
  }

  override table(token: Tokens.Table): string {
    const table = super.table(token).replace("<table>", '<table class="reference">');
    return `<div class="table-scroll" tabindex="0">${table}</div>\n`;
  }

  override tablecell(token: Tokens.TableCell): string {
    // A column without a name, such as that of names, has no header to tell.
    if (token.header && token.text === "") return "<td></td>\n";
    return super.tablecell(token).replace(/^<th\b/, '<th scope="col"');
  }

  override link({ href: target, tokens }: Tokens.Link): string {
    const words = this.parser.parseInline(tokens);
    const anchor = anchorOf(target, this.file);
    return anchor === null ? words : `<a href="${href({ page: "help", name: anchor })}">${words}</a>`;
  }

  override image({ raw, text }: Tokens.Image): string {
    return this.text({ type: "text", raw, text, escaped: false });
  }
}
